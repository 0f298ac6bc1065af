// Builds the page from the run stored in it.
import { answer, funnel } from "./answer.js";
import { convergence } from "./convergence.js";
import { dimensions } from "./dimensions.js";
import { el } from "./dom.js";
import { licences } from "./licences.js";
import { provenance } from "./provenance.js";
import { ranking } from "./ranking.js";
import { rejected } from "./rejected.js";
import { requirements } from "./requirements.js";
import { Selection, readRun } from "./run.js";
import { SchemePanel } from "./scheme.js";
import { duel, stability } from "./stability.js";
import { verdict } from "./verdict.js";
import { words } from "./words.js";
import { WorkspacePanel } from "./workspace.js";

/** Runs one part of the page; what fails is reported and leaves the others alone. */
function guarded(name, build) {
  try {
    return build();
  } catch (error) {
    console.error(`report: ${name} could not be drawn:`, error);
    return el("p", { class: "failed" }, `This part could not be drawn: ${error.message}`);
  }
}

const present = (content) => content !== null && content !== undefined && content !== false && (!Array.isArray(content) || content.some(Boolean));

/** A section, or null when the run holds nothing for it. */
function section(id, title, build) {
  const content = guarded(title, build);
  return present(content) ? el("section", { id }, el("h2", {}, title), content) : null;
}

/** A part of the machine section that is redrawn for every selected layout. */
function followed(selection, title, render) {
  const body = el("div", {});
  const node = el("div", { class: "part" }, el("h3", {}, title), body);
  selection.follow((entry) => {
    const content = guarded(title, () => render(entry));
    node.hidden = !present(content);
    if (!node.hidden) body.replaceChildren(...[content].flat().filter(Boolean));
  });
  return node;
}

function chooser(run, selection) {
  const option = ([id, entry]) => el("option", { value: id }, `${selection.shortName(id)} – ${selection.title(entry)}`);
  const all = [...selection.entries];
  const groups = [["Ranked layouts", all.filter(([, e]) => !e.rejected).sort(([a], [b]) => (selection.rankOf(a) ?? 1e9) - (selection.rankOf(b) ?? 1e9))], ["Rejected layouts", all.filter(([, e]) => e.rejected)]];
  const select = el("select", { "aria-label": "layout shown", onchange: (event) => selection.select(event.target.value) },
    groups.filter(([, list]) => list.length).map(([label, list]) => el("optgroup", { label }, list.map(option))));
  selection.follow((entry) => { select.value = entry.id; });
  return el("label", { class: "chooser" }, "Layout shown: ", select);
}

function heading(entry, selection) {
  const rank = selection.rankOf(entry.id);
  const choices = Object.entries(entry.choices ?? {});
  return [
    el("p", { class: "shown" }, el("span", { class: `verdict ${entry.rejected ? "bad" : "good"}` }, entry.rejected ? "rejected" : rank ? `rank ${rank}` : "layout"), " ", el("b", {}, selection.title(entry)), " ", el("small", {}, [entry.known_as, entry.id].filter(Boolean).join(" · "))),
    entry.rejected && el("p", {}, `Rejected: ${entry.rejected}.`),
    choices.length > 0 && el("p", { class: "choices" }, choices.map(([name, value]) => el("span", {}, `${name.replaceAll("_", " ")}: `, el("b", {}, String(value))))),
  ].filter(Boolean);
}

function machine(run, selection) {
  if (!selection.current) return null;
  const scheme = new SchemePanel();
  const workspace = new WorkspacePanel(run);
  const title = el("div", {});
  selection.follow((entry) => title.replaceChildren(...heading(entry, selection)));
  const schemePart = el("div", { class: "part" }, el("h3", {}, "Kinematic scheme"), scheme.node);
  selection.follow((entry) => {
    guarded("scheme", () => scheme.show(entry));
    schemePart.hidden = scheme.node.hidden;
  });
  const parts = [chooser(run, selection), title, schemePart,
    followed(selection, "Dimensions", dimensions),
    followed(selection, "Workspace", (entry) => workspace.render(entry)),
    followed(selection, "Why this verdict", verdict),
    followed(selection, "How tuning went", (entry) => convergence(entry))];
  return { parts, scheme };
}

/** Counts what is really in the page, for tests and for whoever wonders. */
function countMarks(scheme) {
  const marks = document.documentElement.dataset;
  const all = (selector) => document.querySelectorAll(selector).length;
  marks.rankRows = all("table.ranking tbody tr");
  marks.rankPictures = all("table.ranking .thumb svg");
  marks.heatmapCells = all(".heat svg path");
  marks.chartMarks = all(".chart svg path");
  marks.drawingLines = all("svg.drawing line");
  marks.dimensionLabels = all("svg.drawing .dimension");
  marks.schemeSegments = scheme?.view?.marks ?? 0;
  marks.schemePixels = scheme?.view && scheme.entry ? scheme.view.drawnPixels() : 0;
  marks.rendered = "true";
}

function build() {
  const run = readRun();
  const selection = new Selection(run);
  let scheme = null;
  const study = run.kind === "study";
  document.getElementById("report").replaceChildren(...[
    el("header", {}, el("h1", {}, run.title || run.name || "Design report"), run.about && el("p", { class: "about" }, run.about),
      el("p", { class: "answer" }, answer(run, selection)), funnel(run)),
    section("requirements", "What was asked", () => requirements(run)),
    section("ranking", study ? "Result" : "Ranking", () => ranking(run, selection)),
    section("machine", "The machine", () => {
      const built = machine(run, selection);
      scheme = built?.scheme;
      return built?.parts;
    }),
    section("stability", "Can the ranking be relied on?", () => stability(run, selection)),
    section("duel", "Two layouts held against each other", () => duel(run)),
    section("rejected", "Rejected layouts, by reason", () => rejected(run, selection)),
    section("words", "Words used", words),
    section("provenance", "Where the numbers come from", () => provenance(run)),
    el("footer", {}, "Made by polyglide. This file needs no network. ", licences()),
  ].filter(Boolean));
  requestAnimationFrame(() => requestAnimationFrame(() => guarded("page", () => countMarks(scheme))));
}

build();
