// Words that a machine designer may meet here for the first time.
import { el } from "./dom.js";

const WORDS = [
  ["home", "The posture in which the machine is described. Drives, platform and tool displacements count from it."],
  ["determinate", "The drives fix the platform: with all of them held nothing can move, and none of them works against another."],
  ["uncertain", "With all drives held the platform still moves. Such a layout is rejected; the motion that is left is shown."],
  ["singular posture", "A posture in which the drives lose hold of the platform, or the platform loses a direction."],
  ["condition number κ", "Ratio of the largest to the smallest tool speed the drives give, over all directions. The maps show 1/κ, from 0 (singular) to 1 (the same in all directions)."],
  ["3T1R", "Three translations and one rotation. X, Y, Z are translations along, A, B, C rotations about the base axes x, y, z."],
  ["tool displacement", "Where the tool is, counted from its place at home, along the base axes. All workspace maps use it."],
];

export const words = () => el("dl", { class: "words" }, WORDS.flatMap(([term, meaning]) => [el("dt", {}, term), el("dd", {}, meaning)]));
