// Where the numbers come from, so that they can be made again.
import { el, table } from "./dom.js";
import { number } from "./format.js";

const WORDS = { version: "polyglide version", seed: "random seed", threads: "threads (results do not depend on them)", command: "command", started: "started", seconds: "duration", machine: "machine" };

function value(key, content) {
  if (key === "seconds") return `${number(content, 3)}\u00a0s`;
  if (key === "started") return String(content).replace("T", " ").replace("Z", " UTC");
  if (key === "command") return el("code", {}, String(content));
  return String(content);
}

export function provenance(run) {
  const data = run.provenance;
  if (!data) return null;
  const rows = [];
  for (const [key, content] of Object.entries(data)) {
    if (content === null || content === undefined) continue;
    if (typeof content === "object") {
      for (const [name, item] of Object.entries(content)) rows.push([`${key === "hashes" ? "content hash of" : key.replace(/s$/, "")} ${name.replace("_", " ")}`, el("code", {}, typeof item === "number" ? number(item) : String(item))]);
    } else rows.push([WORDS[key] ?? key, value(key, content)]);
  }
  return [
    table(null, rows, { className: "provenance" }),
    run.brief && el("details", {}, el("summary", {}, run.kind === "study" ? "The study as it was given" : "The brief as it was given"), el("pre", {}, JSON.stringify(run.brief, null, 2))),
  ];
}
