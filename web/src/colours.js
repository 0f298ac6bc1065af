// Colours that stay apart for colour-blind readers and in grey print (Okabe and Ito).

export const INK = "#1d2733";
export const MUTED = "#5b6875";
export const GRID = "#dfe4e9";
export const ACCENT = "#0b5c8f";

export const SERIES = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#6b5b95", "#8c6d31"];

/** Viridis, nine stops from low to high. */
export const VIRIDIS = ["#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c", "#28ae80", "#5ec962", "#addc30", "#fde725"];

/** [r, g, b] of viridis at `share` in 0..1. */
export function viridis(share) {
  const at = Math.min(1, Math.max(0, share)) * (VIRIDIS.length - 1);
  const low = Math.min(VIRIDIS.length - 2, Math.floor(at));
  const channel = (stop, k) => parseInt(VIRIDIS[stop].slice(1 + 2 * k, 3 + 2 * k), 16);
  return [0, 1, 2].map((k) => Math.round(channel(low, k) + (at - low) * (channel(low + 1, k) - channel(low, k))));
}

export const BODY = { guide: "#39424c", rod: "#0072b2", strut: "#0072b2", link: "#4c7aa0", carriage: "#56b4e9", platform: "#e69f00", tool: "#b3261e" };

export const JOINT = { spherical: "#cc79a7", universal: "#6b3fa0", revolute: "#8c6d31", prismatic: "#39424c", cylindrical: "#7a7f1f", helical: "#7a7f1f", planar: "#7a7f1f", driven: "#009e73" };

export const JOINT_WORDS = {
  spherical: "ball joint (3 rotations)", universal: "universal joint, cross (2 rotations)", revolute: "hinge (1 rotation)",
  prismatic: "slide (1 translation)", cylindrical: "turn-and-slide joint", helical: "screw joint", planar: "planar joint",
};
