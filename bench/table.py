#!/usr/bin/python3
"""Writes the table of bench/README.md from the results in a folder. Usage: table.py FOLDER README"""
import json
import os
import sys

SLOW = 100  # rows below so many a second say how long one takes


def rates(folder):
    """Best rate, operations and cells of every row; peers that are not installed left no file."""
    found, means = {}, {}
    for name in ("batch", "forward", "mobility", "volume", "kdl"):
        for row in read(f"{folder}/{name}.json").get("benchmarks", []):
            if row.get("run_type") != "iteration":
                continue
            best = found.get(row["name"], (0, 0, 0))
            found[row["name"]] = max(best, (row["items_per_second"], row.get("flops", 0), row.get("cells", 0)))
            means[row["name"]] = row.get("mean_index", 0)
    for name in ("numpy", "numpy_mobility", "octave"):
        for work, row in read(f"{folder}/{name}.json").items():
            found[work] = (row["rate"], 0, 0)
            means[work] = row.get("mean_index", 0)
    check(means)
    return found


def read(path):
    return json.load(open(path)) if os.path.exists(path) else {}


def check(means):
    """All who did the same work found the same mean index, of 2,000 poses at least."""
    for name, mean in means.items():
        same = [other for work, other in means.items()
                if other and work.rsplit("/", 1)[0] == name.rsplit("/", 1)[0]]
        if mean and max(same) > 1.01 * min(same):
            sys.exit(f"{name}: mean index {mean}, others {same}")


def processor():
    for line in open("/proc/cpuinfo"):
        if line.startswith("model name"):
            return line.split(":")[1].strip()
    return "unknown processor"


def table(folder):
    found = rates(folder)
    peaks = {kind: found[f"peak/{kind}"][0] * found[f"peak/{kind}"][1]
             for kind in ("v3", "v4") if f"peak/{kind}" in found}
    lines = [f"{processor()}, load average {os.getloadavg()[0]:.1f} while measuring; FMA peak per core: "
             + ", ".join(f"{kind} {peak / 1e9:.1f} GFLOP/s" for kind, peak in peaks.items()) + ".",
             "", "| work | how | M/s per core | operations | of peak | best kernel / it |",
             "|---|---|---|---|---|---|"]
    best = {}
    for name, (rate, _, _) in found.items():
        work = name.rsplit("/", 1)[0]
        best[work] = max(best.get(work, 0), rate)
    for name, (rate, operations, cells) in sorted(found.items()):
        work, how = name.rsplit("/", 1)
        if work == "peak":
            continue
        share = f"{100 * rate * operations / peaks[how]:.0f} %" if how in peaks and operations else ""
        count = f"{operations:.0f}" if operations else f"{cells:.0f} cells" if cells else ""
        speed = f"{rate / 1e6:.3g}" if rate > SLOW else f"{1 / rate:.2g} s each"
        lines.append(f"| {work} | {how} | {speed} | {count} | {share} |"
                     f" {best[work] / rate:.1f} |")
    return "\n".join(lines)


def main(folder, readme):
    text = open(readme).read()
    begin, end = "<!-- table -->", "<!-- end of table -->"
    head, rest = text.split(begin)
    open(readme, "w").write(head + begin + "\n" + table(folder) + "\n" + end + rest.split(end)[1])


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
