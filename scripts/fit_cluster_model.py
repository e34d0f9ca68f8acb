#!/usr/bin/python3
"""Fits the model of the cluster detector on simulated drives and writes cpp/mlo/detection/cluster_weights.inc.

Simulates the drives that are not in OUT yet, lists all candidates of their scans (`mlo detect --candidates`), matches
them with the exact truth, and fits one logistic model per class: a weight for each feature and each product of two. A
candidate is an example of its class by how much of the union it shares with a true box of that class, seen from above;
what lies on an object with too few returns, or on a van when it is taken for a car, says nothing.
"""

import argparse
import csv
import subprocess
from pathlib import Path

import numpy as np
from scipy.optimize import minimize
from scipy.special import expit

CLASSES = ["car", "van", "truck", "pedestrian", "cyclist"]
SCENES = ["city", "suburb", "highway", "jam", "parking"]
NEIGHBOURS = {"car": ["van"], "van": ["car", "truck"], "truck": ["van"], "pedestrian": [], "cyclist": []}
MIN_RETURNS = 5
# From no example at all to a full one.
SHARED_NONE, SHARED_FULL = 0.3, 0.7


def corners(box):
    """Corners of boxes (x, y, length, width, yaw), seen from above: N x 4 x 2."""
    x, y, length, width, yaw = box.T
    along = np.stack([np.cos(yaw), np.sin(yaw)], axis=1)
    across = np.stack([-np.sin(yaw), np.cos(yaw)], axis=1)
    signs = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]])
    return (np.stack([x, y], axis=1)[:, None] + 0.5 * length[:, None, None] * signs[None, :, :1] * along[:, None]
            + 0.5 * width[:, None, None] * signs[None, :, 1:] * across[:, None])


def clipped_area(subject, clip):
    """Area that two convex polygons share (Sutherland-Hodgman)."""
    for i in range(len(clip)):
        a, b = clip[i], clip[(i + 1) % len(clip)]
        side = [(b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) for p in subject]
        kept = []
        for j, p in enumerate(subject):
            k = (j + 1) % len(subject)
            if side[j] >= 0:
                kept.append(p)
            if (side[j] < 0) != (side[k] < 0):
                kept.append(p + (subject[k] - p) * (side[j] / (side[j] - side[k])))
        subject = kept
        if not subject:
            return 0.0
    x, y = np.array(subject).T
    return 0.5 * abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))


def best_shared(boxes, truth):
    """Largest intersection over union of each box with any true one, and with which."""
    best = np.zeros(len(boxes))
    which = np.full(len(boxes), -1)
    if len(boxes) == 0 or len(truth) == 0:
        return best, which
    box_corners, true_corners = corners(boxes), corners(truth)
    reach = 0.5 * (np.hypot(boxes[:, 2], boxes[:, 3])[:, None] + np.hypot(truth[:, 2], truth[:, 3])[None])
    near = np.hypot(boxes[:, None, 0] - truth[None, :, 0], boxes[:, None, 1] - truth[None, :, 1]) < reach
    for i, j in np.argwhere(near):
        shared = clipped_area(list(box_corners[i]), true_corners[j])
        iou = shared / (boxes[i, 2] * boxes[i, 3] + truth[j, 2] * truth[j, 3] - shared)
        if iou > best[i]:
            best[i], which[i] = iou, j
    return best, which


def read_truth(drive):
    by_frame = {}
    with open(drive / "truth" / "objects.csv", newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            box = [float(row[k]) for k in ("lidar_x_m", "lidar_y_m", "length_m", "width_m", "lidar_yaw_rad")]
            by_frame.setdefault(int(row["frame"]), []).append((row["class"], box, int(row["points"])))
    return by_frame


def read_examples(drive, candidates_file):
    """Class, features and target (0 ... 1; NaN where nothing is said) of all candidates of a drive."""
    truth = read_truth(drive)
    with open(candidates_file, newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    first_feature = rows[0].index("yaw_rad") + 1
    names = rows[0][first_feature:]
    kinds = np.array([row[1] for row in rows[1:]])
    values = np.array([[float(v) for v in (row[0], *row[2:])] for row in rows[1:]])
    frames, boxes, features = values[:, 0].astype(int), values[:, [1, 2, 4, 5, 7]], values[:, first_feature - 1:]
    target = np.zeros(len(kinds))
    for frame in np.unique(frames):
        objects = truth.get(frame, [])
        for kind in CLASSES:
            mine = np.flatnonzero((frames == frame) & (kinds == kind))
            own = np.array([box for c, box, points in objects if c == kind and points >= MIN_RETURNS]).reshape(-1, 5)
            unclear = np.array([box for c, box, points in objects
                                if c in NEIGHBOURS[kind] or c == kind and points < MIN_RETURNS]).reshape(-1, 5)
            shared, _ = best_shared(boxes[mine], own)
            target[mine] = np.clip((shared - SHARED_NONE) / (SHARED_FULL - SHARED_NONE), 0, 1)
            doubtful = (best_shared(boxes[mine], unclear)[0] > SHARED_NONE) & (shared <= SHARED_NONE)
            target[mine[doubtful]] = np.nan
    return names, kinds, features, target


def expand(features):
    """1, the features, the products of two."""
    i, j = np.triu_indices(features.shape[1])
    return np.hstack([np.ones((len(features), 1)), features, features[:, i] * features[:, j]])


def fit(features, target, ridge):
    """Weights of a logistic model, with a little shrinkage of all but the constant."""
    terms = expand(features)
    scale = np.maximum(np.sqrt((terms**2).mean(axis=0)), 1e-9)
    terms = terms / scale
    shrink = np.full(terms.shape[1], ridge)
    shrink[0] = 0.0

    def loss(w):
        z = terms @ w
        value = np.mean(np.logaddexp(0, z) - target * z) + 0.5 * np.sum(shrink * w**2)
        return value, terms.T @ (expit(z) - target) / len(target) + shrink * w

    found = minimize(loss, np.zeros(terms.shape[1]), jac=True, method="L-BFGS-B", options={"maxiter": 2000})
    return found.x / scale, found.fun


def list_candidates(options, scene, seed):
    drive = options.out / f"{scene}_{seed}"
    if not (drive / "truth" / "static_map.ply").is_file():  # written last
        subprocess.run([options.program, "--quiet", "simulate", "--scene", scene, "--length", "120", "--scans", str(options.scans),
                        "--seed", str(seed), "--overwrite", "--out", drive], check=True, stdout=subprocess.DEVNULL)
    candidates = options.out / f"{scene}_{seed}_candidates.csv"
    print(f"{scene} {seed}", flush=True)
    subprocess.run([options.program, "--quiet", "detect", drive, "--candidates", candidates], check=True,
                   stdout=subprocess.DEVNULL)
    return read_examples(drive, candidates)


def write_weights(path, command, weights):
    lines = [f"// Made by {command}; not to be changed by hand.",
             "// For each class the constant, the weights of the features, those of their products (i, j), i <= j."]
    for kind in CLASSES:
        numbers = [f"{w:.4g}" for w in weights[kind]]
        rows = [", ".join(numbers[i:i + 14]) for i in range(0, len(numbers), 14)]
        lines.append("{" + ",\n ".join(rows) + "},  // " + kind)
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, required=True, help="folder for drives and candidates")
    parser.add_argument("--program", default="build/bin/mlo")
    parser.add_argument("--seeds", type=int, nargs="+", default=[101, 102, 103, 104])
    parser.add_argument("--scans", type=int, default=60, help="scans of each drive")
    parser.add_argument("--ridge", type=float, default=1e-4, help="shrinkage of the weights")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    parts = [list_candidates(options, scene, seed) for seed in options.seeds for scene in SCENES]
    kinds = np.concatenate([part[1] for part in parts])
    features = np.vstack([part[2] for part in parts])
    target = np.concatenate([part[3] for part in parts])
    weights = {}
    for kind in CLASSES:
        mine = (kinds == kind) & np.isfinite(target)
        weights[kind], loss = fit(features[mine], target[mine], options.ridge)
        print(f"{kind}: {mine.sum()} candidates, {target[mine].sum():.0f} of the class, log loss {loss:.4f}")
    command = f"scripts/fit_cluster_model.py --seeds {' '.join(map(str, options.seeds))} --scans {options.scans} --ridge {options.ridge:g}"
    write_weights(Path(__file__).parent.parent / "cpp/mlo/detection/cluster_weights.inc", command, weights)


if __name__ == "__main__":
    main()
