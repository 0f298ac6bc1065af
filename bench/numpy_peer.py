#!/usr/bin/python3
"""The batch evaluator's work in numpy, on the same poses: as people write it (per pose), with
numpy's batched SVD, and as flat structure-of-arrays in chunks. Prints poses per second of
processor time, one thread. Usage: numpy_peer.py FOLDER (as batch_bench wrote it)."""
import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")
import json
import sys
import time

import numpy as np

if not np.__file__.startswith("/usr/lib/python3/"):
    sys.exit(f"numpy_peer.py: Debian's python3-numpy is the peer, not {np.__file__}")


def best(call, count, repeats=7):
    seconds = []
    for _ in range(repeats):
        start = time.process_time()
        mean = call()
        seconds.append(time.process_time() - start)
    return count / min(seconds), mean


def arrays(machine):
    legs = machine["legs"]
    column = lambda key: np.array([leg[key] for leg in legs])
    return (column("base"), column("direction"), column("platform"), column("length"),
            column("side"), column("stroke"), np.array(machine["tool"]), machine["scale"])


def delta_batched(machine, poses):
    base, guide, platform, length, side, stroke, _, _ = arrays(machine)
    v = poses[:, None, :] + (platform - base)
    s = np.einsum("nij,ij->ni", v, guide)
    p = v - s[..., None] * guide
    h = side * np.sqrt(length**2 - np.einsum("nij,nij->ni", p, p))
    q = s + h
    good = ((q >= stroke[:, 0]) & (q <= stroke[:, 1])).all(1)
    j = guide - p / h[..., None]
    sigma = np.linalg.svd(j, compute_uv=False)
    return float(np.where(good, sigma[:, 2] / sigma[:, 0], 0).mean())


def delta_flat(machine, poses, chunk=20000):
    """Columns only, no small matrices: closed-form eigenvalues of J'J."""
    base, guide, platform, length, side, stroke, _, _ = arrays(machine)
    total = 0.0
    columns = np.ascontiguousarray(poses.T)
    for begin in range(0, poses.shape[0], chunk):
        x, y, z = columns[:, begin:begin + chunk]
        xx = xy = xz = yy = yz = zz = 0.0
        good = True
        for i in range(3):
            a, g = platform[i] - base[i], guide[i]
            vx, vy, vz = x + a[0], y + a[1], z + a[2]
            s = vx * g[0] + vy * g[1] + vz * g[2]
            px, py, pz = vx - s * g[0], vy - s * g[1], vz - s * g[2]
            h = side[i] * np.sqrt(length[i]**2 - (px * px + py * py + pz * pz))
            q = s + h
            good = good & (q >= stroke[i, 0]) & (q <= stroke[i, 1])
            w = 1 / h
            jx, jy, jz = g[0] - px * w, g[1] - py * w, g[2] - pz * w
            xx, xy, xz = xx + jx * jx, xy + jx * jy, xz + jx * jz
            yy, yz, zz = yy + jy * jy, yz + jy * jz, zz + jz * jz
        q = (xx + yy + zz) / 3
        a, b, c = xx - q, yy - q, zz - q
        off = xy * xy + xz * xz + yz * yz
        p = np.sqrt((a * a + b * b + c * c + 2 * off) / 6)
        r = (a * (b * c - yz * yz) - xy * (xy * c - yz * xz) + xz * (xy * yz - b * xz)) / (2 * p**3)
        angle = np.arccos(np.clip(r, -1, 1)) / 3
        most = q + 2 * p * np.cos(angle)
        least = q + 2 * p * np.cos(angle + 2 * np.pi / 3)
        total += np.where(good, np.sqrt(least / most), 0).sum()
    return float(total / poses.shape[0])


def delta_loop(machine, poses):
    base, guide, platform, length, side, stroke, _, _ = arrays(machine)
    total = 0.0
    for t in poses:
        v = t + platform - base
        s = (v * guide).sum(1)
        p = v - s[:, None] * guide
        h = side * np.sqrt(length**2 - (p * p).sum(1))
        q = s + h
        if (q >= stroke[:, 0]).all() and (q <= stroke[:, 1]).all():
            total += 1 / np.linalg.cond(guide - p / h[:, None])
    return total / len(poses)


def hexapod_jacobians(machine, poses):
    base, _, platform, length, _, stroke, tool, scale = arrays(machine)
    a, b, c = poses[:, 3:].T
    sa, ca, sb, cb, sc, cc = np.sin(a), np.cos(a), np.sin(b), np.cos(b), np.sin(c), np.cos(c)
    r = np.empty((len(poses), 3, 3))
    r[:, 0] = np.stack([cc * cb, cc * sb * sa - sc * ca, cc * sb * ca + sc * sa], 1)
    r[:, 1] = np.stack([sc * cb, sc * sb * sa + cc * ca, sc * sb * ca - cc * sa], 1)
    r[:, 2] = np.stack([-sb, cb * sa, cb * ca], 1)
    arm = np.einsum("nij,kj->nki", r, platform - tool)
    v = poses[:, None, :3] + tool + arm - base
    d = np.sqrt(np.einsum("nij,nij->ni", v, v))
    q = d - length
    good = ((q >= stroke[:, 0]) & (q <= stroke[:, 1])).all(1)
    u = v / d[..., None]
    return np.concatenate([u, np.cross(arm, u) / scale], 2), good


def hexapod_svd(machine, poses):
    j, good = hexapod_jacobians(machine, poses)
    sigma = np.linalg.svd(j, compute_uv=False)
    return float(np.where(good, sigma[:, 5] / sigma[:, 0], 0).mean())


def hexapod_frobenius(machine, poses):
    j, good = hexapod_jacobians(machine, poses)
    inverse = np.linalg.inv(j)
    k = np.sqrt((j * j).sum((1, 2)) * (inverse * inverse).sum((1, 2)))
    return float(np.where(good, 6 / k, 0).mean())


def main(folder):
    machines = json.load(open(f"{folder}/machines.json"))
    delta, hexapod = (np.loadtxt(f"{folder}/{name}_poses.txt") for name in ("delta", "hexapod"))
    few = 2000
    rows = {
        "delta/condition/numpy flat": (delta_flat, "delta", delta),
        "delta/condition/numpy svd": (delta_batched, "delta", delta),
        "delta/condition/numpy loop": (delta_loop, "delta", delta[:few]),
        "hexapod/condition/numpy svd": (hexapod_svd, "hexapod", hexapod),
        "hexapod/frobenius/numpy inv": (hexapod_frobenius, "hexapod", hexapod),
    }
    results = {}
    for name, (call, machine, poses) in rows.items():
        rate, mean = best(lambda: call(machines[machine], poses), len(poses))
        results[name] = {"rate": rate, "mean_index": mean}
    json.dump(results, sys.stdout, indent=1)
    print()


if __name__ == "__main__":
    main(sys.argv[1])
