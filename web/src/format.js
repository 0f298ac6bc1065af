// Numbers as people read them. The run holds metres and radians; the page shows
// millimetres and degrees, and every number with its unit.

const isNumber = (value) => typeof value === "number" && Number.isFinite(value);

/** `value` with `digits` significant digits, without exponent where readable. */
export function number(value, digits = 4) {
  if (!isNumber(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e7 || size < 1e-4) {
    const [mantissa, exponent] = value.toExponential(Math.min(digits, 3) - 1).split("e");
    const raised = String(Number(exponent)).replace(/./g, (c) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(c)]);
    return `${mantissa === "1.00" ? "" : `${mantissa}·`}10${raised}`;
  }
  const decimals = Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
  const [whole, fraction] = value.toFixed(decimals).replace("-", "−").split(".");
  const grouped = whole.replace(/\B(?=(\d{3})+$)/g, "\u202f");
  const rest = (fraction ?? "").replace(/0+$/, "");
  return rest ? `${grouped}.${rest}` : grouped;
}

/** A count, digits grouped. */
export const count = (value) => (isNumber(value) ? number(value, 15) : "–");

const withUnit = (text, unit) => (text === "–" || !unit ? text : unit === "°" ? `${text}°` : `${text}\u00a0${unit}`);

export const quantity = (value, unit, digits) => withUnit(number(value, digits), unit);
export const millimetres = (metres, digits = 4) => quantity(isNumber(metres) ? metres * 1e3 : null, "mm", digits);
export const degrees = (radians, digits = 4) => quantity(isNumber(radians) ? radians * 180 / Math.PI : null, "°", digits);
export const litres = (cubicMetres) => quantity(isNumber(cubicMetres) ? cubicMetres * 1e3 : null, "dm³");
export const percent = (share) => quantity(share * 100, "%", 3);

/** A parameter's unit as the page writes it. */
export const unitName = (unit) => (unit === "deg" || unit === "angle" ? "°" : unit === "none" || !unit ? "" : unit === "length" ? "mm" : unit);

/** An index value in its shown unit. */
export const indexValue = (index, value) =>
  quantity(isNumber(value) ? value * (index?.scale ?? 1) : null, index?.unit ?? "");

/** A drive's displacement from home: signed, mm or degrees. */
export function driveValue(drive, value) {
  const angular = drive.unit === "rad";
  const shown = angular ? value * 180 / Math.PI : value * 1e3;
  const text = Math.abs(shown) < 0.05 ? "0.0" : `${shown > 0 ? "+" : "−"}${Math.abs(shown).toFixed(1)}`;
  return withUnit(text, angular ? "°" : "mm");
}

/** size × size × size in mm, from metres. */
export const box = (size) => `${size.map((s) => number(s * 1e3, 4)).join(" × ")}\u00a0mm`;

/** A point in mm, from metres. */
export const point = (p) => `(${p.map((s) => (Math.abs(s) < 5e-8 ? "0" : number(s * 1e3, 4))).join(", ")})\u00a0mm`;

/** "3T1R" said in words. */
export function motionWords(platform) {
  if (!platform) return "";
  const part = (n, word) => (n ? `${["no", "one", "two", "three"][n] ?? n} ${word}${n > 1 ? "s" : ""}` : null);
  return [part(platform.translations, "translation"), part(platform.rotations, "rotation")].filter(Boolean).join(" and ") || "none";
}
