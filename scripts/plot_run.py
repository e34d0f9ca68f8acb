#!/usr/bin/python3
"""Draws a folder of `mlo run`: the static map from above with the trajectory, and each scan's time and residual.

With --truth, true lidar poses (KITTI rows, one per scan) are drawn too, aligned to the estimate by the rigid motion
that fits best. --area and --heights look at a part of the map: double walls show in a thin slice seen closely.
"""

import argparse
import csv
import re
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

LABEL_COLOURS = {0: ("unknown", "#999999"), 1: ("ground", "#b9a27c"), 2: ("edge", "#d1495b"),
                 3: ("surface", "#2e6f9e"), 4: ("object", "#7b2d8b")}
PLY_TYPES = {"float": "<f4", "double": "<f8", "uchar": "u1", "ushort": "<u2", "int": "<i4"}
STAGES = ["prepare", "perception", "odometry", "refinement", "map_update"]


def read_map(path):
    """The vertices of a binary PLY as a structured array with x, y, z and label."""
    with open(path, "rb") as file:
        header = []
        while not header or header[-1] != "end_header":
            line = file.readline()
            if not line:
                sys.exit(f"{path}: not a PLY file, its header has no end")
            header.append(line.decode("ascii", "replace").strip())
        if "format binary_little_endian 1.0" not in header:
            sys.exit(f"{path}: not a binary PLY as 'mlo run' writes it")
        count = next(int(line.split()[-1]) for line in header if line.startswith("element vertex"))
        fields = re.findall(r"^property (\w+) (\w+)$", "\n".join(header), re.MULTILINE)
        return np.fromfile(file, [(name, PLY_TYPES[kind]) for kind, name in fields], count)


def read_poses(path):
    """Poses [n, 3, 4] from KITTI rows."""
    return np.loadtxt(path, ndmin=2).reshape(-1, 3, 4)


def read_scans(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def align(points, target):
    """Points moved by the rigid motion that brings them nearest to their targets (Umeyama 1991, no scale)."""
    mean_points, mean_target = points.mean(axis=0), target.mean(axis=0)
    u, _, vt = np.linalg.svd((target - mean_target).T @ (points - mean_points))
    flip = np.diag([1.0, 1.0, np.linalg.det(u) * np.linalg.det(vt)])
    return (points - mean_points) @ (u @ flip @ vt).T + mean_target


def select(points, area, heights, limit):
    """The points within area and heights, at most `limit` of them, spread evenly and low ones first."""
    keep = np.ones(len(points), bool)
    if area:
        x_min, x_max, y_min, y_max = area
        keep &= (points["x"] >= x_min) & (points["x"] <= x_max) & (points["y"] >= y_min) & (points["y"] <= y_max)
    if heights:
        keep &= (points["z"] >= heights[0]) & (points["z"] <= heights[1])
    points = points[keep]
    if len(points) > limit:
        points = points[np.linspace(0, len(points) - 1, limit).astype(int)]
    return points[np.argsort(points["z"], kind="stable")]


def draw_map(axes, points, colour, dot):
    if colour == "height":
        low, high = np.percentile(points["z"], [2, 98]) if len(points) else (0, 1)
        dots = axes.scatter(points["x"], points["y"], c=points["z"], s=dot, vmin=low, vmax=high, cmap="viridis",
                            linewidths=0)
        axes.figure.colorbar(dots, ax=axes, label="height [m]", shrink=0.6)
        return
    colours = np.array([LABEL_COLOURS[label][1] for label in range(len(LABEL_COLOURS))])
    axes.scatter(points["x"], points["y"], c=colours[points["label"]], s=dot, linewidths=0)
    for label in np.unique(points["label"]):
        name, value = LABEL_COLOURS[label]
        axes.scatter([], [], c=value, s=20, label=name)


def view(positions, margin):
    """The surroundings of a path; what lies farther out is sparse."""
    low, high = positions[:, :2].min(axis=0) - margin, positions[:, :2].max(axis=0) + margin
    return low[0], high[0], low[1], high[1]


def draw_paths(axes, estimate, truth):
    axes.plot(estimate[:, 0], estimate[:, 1], "k-", linewidth=1.6, label="estimate")
    axes.plot(*estimate[0, :2], "ko", markersize=5)
    if truth is not None:
        moved = align(truth[: len(estimate)], estimate[: len(truth)])
        axes.plot(moved[:, 0], moved[:, 1], "--", color="#ffb000", linewidth=1.6, label="truth, aligned")


def draw_times(axes, scans):
    frames = [int(row["frame"]) for row in scans]
    times = [[float(row[f"{stage}_ms"] or 0) for row in scans] for stage in STAGES]
    axes.stackplot(frames, times, labels=STAGES)
    axes.set_ylabel("time [ms]")
    axes.legend(loc="upper left", ncol=len(STAGES), fontsize=7, frameon=False)


def draw_residuals(axes, scans):
    frames = np.array([int(row["frame"]) for row in scans])
    residuals = np.array([float(row["rms_residual_m"] or "nan") for row in scans])
    localised = np.array([row["status"] in ("first", "localised") for row in scans])
    axes.plot(frames[1:], 1000.0 * residuals[1:], color="#2e6f9e", linewidth=1)
    for frame in frames[~localised]:
        axes.axvline(frame, color="#d1495b", linewidth=2)
    axes.set_ylabel("RMS residual [mm]")
    axes.set_xlabel(f"scan ({np.count_nonzero(~localised)} without a pose of their own, red)")
    axes.set_ylim(bottom=0)


def draw(run, truth_path, options):
    positions = read_poses(run / "trajectory.txt")[:, :, 3]
    truth = read_poses(truth_path)[:, :, 3] if truth_path else None
    area = options.area or view(positions, options.margin)
    points = select(read_map(run / "static_map.ply"), area, options.heights, options.points)
    scans = read_scans(run / "per_scan.csv")
    if options.map_only:
        figure, axes = plt.subplots(figsize=(10, 6.5), layout="constrained")
    else:
        figure, (axes, times, residuals) = plt.subplots(3, 1, figsize=(10, 9), layout="constrained",
                                                        height_ratios=[5, 1, 1])
        draw_times(times, scans)
        draw_residuals(residuals, scans)
    draw_map(axes, points, options.colour, options.dot)
    draw_paths(axes, positions, truth)
    axes.set_aspect("equal")
    axes.set_xlim(area[0], area[1])
    axes.set_ylim(area[2], area[3])
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")
    axes.legend(loc="upper right", fontsize=8, markerscale=1.5)
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", type=Path, help="folder that 'mlo run --out' wrote")
    parser.add_argument("--out", type=Path, required=True, help="PNG file")
    parser.add_argument("--truth", type=Path)
    parser.add_argument("--colour", choices=["label", "height"], default="label")
    parser.add_argument("--area", type=float, nargs=4, metavar=("X_MIN", "X_MAX", "Y_MIN", "Y_MAX"), help="[m]")
    parser.add_argument("--heights", type=float, nargs=2, metavar=("MIN", "MAX"), help="only these z [m]")
    parser.add_argument("--margin", type=float, default=40.0, help="around the path, without --area [m]")
    parser.add_argument("--points", type=int, default=200000, help="draw at most this many")
    parser.add_argument("--dot", type=float, default=0.3, help="size of a point")
    parser.add_argument("--map-only", action="store_true", help="leave out times and residuals")
    parser.add_argument("--dpi", type=int, default=100)
    options = parser.parse_args()
    options.out.parent.mkdir(parents=True, exist_ok=True)
    draw(options.run, options.truth, options).savefig(options.out, dpi=options.dpi)


if __name__ == "__main__":
    main()
