#!/usr/bin/python3
"""The four ranks of a mobility decision by numpy: singular values of the closure matrices at home and at
a generic posture, free and with drives held. It is given the postures; finding them is not timed.
A file holds one machine or a group, four matrices each.
Usage: numpy_mobility.py FOLDER, prints {name: {"rate": candidates per second}}."""
import glob
import json
import os
import sys
import time

import numpy as np


def matrices(path):
    found = []
    for line in open(path):
        numbers = np.array(line.split(), dtype=float)
        rows, cols = int(numbers[0]), int(numbers[1])
        found.append(numbers[2:].reshape(rows, cols))
    return found


def rank(matrix):
    values = np.linalg.svd(matrix, compute_uv=False)
    return int((values > 1e-7 * values[0]).sum())


def best_rate(work):
    work()
    best = float("inf")
    for _ in range(15):
        start = time.process_time()
        repeats = 0
        while time.process_time() - start < 0.05:
            work()
            repeats += 1
        best = min(best, (time.process_time() - start) / repeats)
    return 1 / best


def main(folder):
    found = {}
    for path in sorted(glob.glob(f"{folder}/mobility-*.txt")):
        all_of_them = matrices(path)
        name = os.path.basename(path)[len("mobility-"):-len(".txt")]
        found[f"check {name}/numpy, four ranks only"] = {
            "rate": len(all_of_them) / 4 * best_rate(lambda: [rank(matrix) for matrix in all_of_them])}
    print(json.dumps(found))


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    main(sys.argv[1])
