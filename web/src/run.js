// The stored run and what is selected in it.

/** Parses the data island of the page. */
export const readRun = () => JSON.parse(document.getElementById("run").textContent);

/** A run with everything findable by id, and one selected entry that parts of the page follow. */
export class Selection {
  constructor(run) {
    this.run = run;
    this.listeners = [];
    window.addEventListener("hashchange", () => this.select(this.asked()));
    this.entries = new Map();
    for (const group of run.rejected ?? []) {
      for (const example of group.examples ?? []) this.entries.set(example.id, { ...example, rejected: group.reason });
    }
    for (const layout of run.layouts ?? []) this.entries.set(layout.id, layout);
    const first = (run.ranking ?? []).find((row) => this.entries.has(row.layout))?.layout;
    this.current = this.entries.get(this.asked()) ?? this.entries.get(first) ?? this.entries.values().next().value ?? null;
  }

  /** The layout named in the page's address, report.html#layout-<id>. */
  asked() {
    return location.hash.startsWith("#layout-") ? location.hash.slice("#layout-".length) : null;
  }

  select(id) {
    const entry = this.entries.get(id);
    if (!entry || entry === this.current) return;
    this.current = entry;
    for (const listener of this.listeners) listener(entry);
  }

  /** Calls `listener(entry)` now and at every change. */
  follow(listener) {
    this.listeners.push(listener);
    if (this.current) listener(this.current);
  }

  rankOf(id) {
    return (this.run.ranking ?? []).find((row) => row.layout === id)?.rank ?? null;
  }

  /** "1 · table1-6": short enough for axes and lists. */
  shortName(id) {
    const entry = this.entries.get(id) ?? (this.run.ranking ?? []).find((row) => row.layout === id) ?? {};
    const rank = this.rankOf(id);
    const name = entry.known_as ?? String(id).slice(0, 6);
    return rank ? `${rank} · ${name}` : name;
  }

  title(entry) {
    return entry.title || entry.known_as || entry.id;
  }
}
