#!/usr/bin/python3
"""Compares folders of KITTI .bin scans: how much do simulated scans resemble real ones?

For each folder: points per scan and per ring, histograms of range and incidence angle, intensity, share of
ground, how steeply counts fall with range, and how well consecutive scans agree where nothing moves (point to
plane, after the motion between them was estimated from the scans themselves). Everything is computed in the
same way for all folders, from the points alone, so that differences are those of the scans.

Examples:
  scripts/compare_scans.py DIR/velodyne/0000 KITTI/sequences/04/velodyne --labels simulated real
  scripts/compare_scans.py A B C --scans 10 --out comparison.png
"""
import argparse
import pathlib

import numpy as np

RANGE_EDGES_M = np.array([2, 5, 8, 12, 18, 25, 35, 50, 65, 80])
INCIDENCE_EDGES_DEG = np.arange(0, 91, 10)
SENSOR_HEIGHT_M = 1.73


def read_scan(path):
    points = np.fromfile(path, np.float32).reshape(-1, 4)
    return points[np.isfinite(points).all(axis=1)]


def rings_of(points):
    """Scan lines: a new one begins where the azimuth comes round to straight ahead."""
    azimuth = np.mod(np.arctan2(points[:, 1], points[:, 0]), 2 * np.pi)
    wraps = (azimuth[1:] < 0.5 * np.pi) & (azimuth[:-1] > 1.5 * np.pi)
    return np.concatenate([[0], np.cumsum(wraps)])


def ground_mask(points):
    """Points near the plane through the lowest returns around (one robust fit, 0.15 m, within 40 m)."""
    near = np.linalg.norm(points[:, :2], axis=1) < 40.0
    low = near & (np.abs(points[:, 2] + SENSOR_HEIGHT_M) < 0.6)
    if low.sum() < 100:
        return np.zeros(len(points), bool)
    A = np.column_stack([points[low, 0], points[low, 1], np.ones(low.sum())]).astype(np.float64)
    z = points[low, 2].astype(np.float64)
    keep = np.ones(len(z), bool)
    for _ in range(5):
        plane, *_ = np.linalg.lstsq(A[keep], z[keep], rcond=None)
        keep = np.abs(A @ plane - z) < 0.15
    heights = points[:, 2] - (points[:, :2] @ plane[:2] + plane[2])
    return np.abs(heights) < 0.15


class Neighbours:
    """Nearest points by cells of a grid, without further libraries."""

    def __init__(self, points, cell_m):
        self.points, self.cell_m = points, cell_m
        keys = self._keys(np.floor(points / cell_m).astype(np.int64))
        self.order = np.argsort(keys, kind="stable")
        self.keys = keys[self.order]

    @staticmethod
    def _keys(cells):
        offset = cells + (1 << 19)
        return (offset[:, 0] << 40) | (offset[:, 1] << 20) | offset[:, 2]

    def around(self, query, most):
        """Indices of up to `most` points in the 27 cells around a place."""
        cell = np.floor(query / self.cell_m).astype(np.int64)
        shifts = np.array([[x, y, z] for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)])
        keys = self._keys(cell + shifts)
        first = np.searchsorted(self.keys, keys, "left")
        last = np.searchsorted(self.keys, keys, "right")
        found = np.concatenate([self.order[a:b] for a, b in zip(first, last)])
        if len(found) > most:
            distance = np.sum((self.points[found] - query) ** 2, axis=1)
            found = found[np.argpartition(distance, most)[:most]]
        return found


def planes_at(neighbours, queries):
    """Normal, centre and thickness of the surface around each place; NaN where it is not flat."""
    normals = np.full((len(queries), 3), np.nan)
    centres = np.full((len(queries), 3), np.nan)
    for i, query in enumerate(queries):
        near = neighbours.points[neighbours.around(query, 20)]
        if len(near) < 8:
            continue
        centre = near.mean(axis=0)
        values, vectors = np.linalg.eigh(np.cov((near - centre).T))
        if values[0] < 0.05 * values[1] and values[1] > 0.05 * values[2]:
            normals[i], centres[i] = vectors[:, 0], centre
    return normals, centres


def align_and_residual(source, target, initial, iterations=12):
    """Point-to-plane registration; returns the motion and the residuals [m] that remain."""
    neighbours = Neighbours(target, 0.6)
    R, t = initial
    residuals = np.array([])
    for iteration in range(iterations):
        gate = 1.0 if iteration < 5 else 0.3
        moved = source @ R.T + t
        normals, centres = planes_at(neighbours, moved)
        r = np.einsum("ij,ij->i", normals, moved - centres)
        good = np.isfinite(r) & (np.abs(r) < gate)
        if good.sum() < 50:
            break
        residuals = r[good]
        J = np.column_stack([np.cross(moved[good], normals[good]), normals[good]])
        weight = 1.0 / (1.0 + (residuals / 0.1) ** 2)
        step = np.linalg.lstsq(J * weight[:, None] ** 0.5, -residuals * weight**0.5, rcond=None)[0]
        angle = np.linalg.norm(step[:3])
        K = np.cross(np.eye(3), step[:3] / max(angle, 1e-12))
        dR = np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K
        R, t = dR @ R, dR @ t + step[3:]
    return (R, t), residuals


def consecutive_residuals(scans, random):
    """Absolute residuals [m] between consecutive scans. The first motion is searched for along x."""
    result, motion = [], None
    for before, after in zip(scans[:-1], scans[1:]):
        target = before[:, :3].astype(np.float64)
        source = after[:, :3].astype(np.float64)
        source = source[np.linalg.norm(source, axis=1) < 50.0]
        source = source[random.permutation(len(source))[:1500]]
        guesses = [motion] if motion else [(np.eye(3), np.array([x, 0.0, 0.0])) for x in (0.0, 0.6, 1.2, 1.8, 2.4)]
        tries = [align_and_residual(source, target, guess) for guess in guesses]
        motion, residuals = min(tries, key=lambda found: np.median(np.abs(found[1])) if len(found[1]) else 1e9)
        result.append(np.abs(residuals))
    return np.concatenate(result) if result else np.array([])


def incidence_angles_deg(points, random):
    xyz = points[:, :3].astype(np.float64)
    queries = xyz[random.permutation(len(xyz))[:1500]]
    normals, _ = planes_at(Neighbours(xyz, 0.6), queries)
    flat = np.isfinite(normals[:, 0])
    beam = queries[flat] / np.linalg.norm(queries[flat], axis=1)[:, None]
    return np.degrees(np.arccos(np.clip(np.abs(np.einsum("ij,ij->i", normals[flat], beam)), 0, 1))), flat.mean()


def shares(values, edges):
    counts, _ = np.histogram(values, bins=edges)
    return counts / max(1, counts.sum())


def describe(folder, count, seed):
    files = sorted(pathlib.Path(folder).glob("*.bin"))
    if not files:
        raise SystemExit(f"{folder}: no .bin scans; give a folder such as .../velodyne")
    start = max(0, (len(files) - count) // 2)
    scans = [read_scan(file) for file in files[start:start + count]]
    random = np.random.default_rng(seed)
    every = np.concatenate(scans)
    ranges = np.linalg.norm(every[:, :3], axis=1)
    per_ring = np.zeros((len(scans), 64))
    ground = []
    for i, scan in enumerate(scans):
        counts = np.bincount(rings_of(scan), minlength=64)[:64]
        per_ring[i] = counts
        ground.append(ground_mask(scan).mean())
    angles, flat = zip(*(incidence_angles_deg(scan, random) for scan in scans[:3]))
    return {
        "scans": len(scans),
        "points": np.mean([len(scan) for scan in scans]),
        "rings": np.mean([rings_of(scan).max() + 1 for scan in scans]),
        "per_ring": per_ring.mean(axis=0),
        "range": shares(ranges, RANGE_EDGES_M),
        "incidence": shares(np.concatenate(angles), INCIDENCE_EDGES_DEG),
        "flat": np.mean(flat),
        "intensity": np.percentile(every[:, 3], [5, 25, 50, 75, 95]),
        "ground": np.mean(ground),
        "residuals": consecutive_residuals(scans[:6], random),
    }


def print_table(labels, found):
    def row(name, values):
        print(f"{name:32}" + "".join(f"{value:>16}" for value in values))

    row("", labels)
    row("scans", [f["scans"] for f in found])
    row("points per scan", [f"{f['points']:.0f}" for f in found])
    row("rings found", [f"{f['rings']:.1f}" for f in found])
    for first in range(0, 64, 8):
        row(f"points per ring {first}-{first + 7}", [f"{f['per_ring'][first:first + 8].mean():.0f}" for f in found])
    for i in range(len(RANGE_EDGES_M) - 1):
        row(f"range {RANGE_EDGES_M[i]}-{RANGE_EDGES_M[i + 1]} m", [f"{100 * f['range'][i]:.1f} %" for f in found])
    for i in range(len(INCIDENCE_EDGES_DEG) - 1):
        row(f"incidence {INCIDENCE_EDGES_DEG[i]}-{INCIDENCE_EDGES_DEG[i + 1]} deg",
            [f"{100 * f['incidence'][i]:.1f} %" for f in found])
    row("share on flat surfaces", [f"{100 * f['flat']:.1f} %" for f in found])
    row("share on the ground", [f"{100 * f['ground']:.1f} %" for f in found])
    for i, percent in enumerate((5, 25, 50, 75, 95)):
        row(f"intensity, percentile {percent}", [f"{f['intensity'][i]:.2f}" for f in found])
    for percent in (50, 75, 90):
        row(f"scan-to-scan residual, p{percent}",
            [f"{1000 * np.percentile(f['residuals'], percent):.1f} mm" if len(f["residuals"]) else "-" for f in found])


def draw(labels, found, out):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(2, 2, figsize=(13, 9))
    for label, f in zip(labels, found):
        axes[0, 0].plot(f["per_ring"], label=label)
        axes[0, 1].plot(0.5 * (RANGE_EDGES_M[1:] + RANGE_EDGES_M[:-1]), f["range"], "o-", label=label)
        axes[1, 0].plot(INCIDENCE_EDGES_DEG[:-1] + 5, f["incidence"], "o-", label=label)
        if len(f["residuals"]):
            axes[1, 1].hist(1000 * f["residuals"], bins=np.arange(0, 150, 5), density=True, histtype="step", label=label)
    for axis, title in zip(axes.flat, ("points per ring (0: highest)", "share by range [m]",
                                       "share by incidence [deg]", "scan-to-scan residual [mm]")):
        axis.set_title(title)
        axis.grid(alpha=0.3)
        axis.legend()
    figure.tight_layout()
    figure.savefig(out, dpi=90)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", help="folders of .bin scans")
    parser.add_argument("--labels", nargs="+", help="a name for each folder")
    parser.add_argument("--scans", type=int, default=10, help="how many, from the middle of each folder")
    parser.add_argument("--seed", type=int, default=1, help="of the random choice of points")
    parser.add_argument("--out", help="also draw a figure into this file")
    arguments = parser.parse_args()
    labels = arguments.labels or [pathlib.Path(folder).parent.name[-15:] for folder in arguments.folders]
    if len(labels) != len(arguments.folders):
        parser.error("--labels needs one name per folder")
    found = [describe(folder, arguments.scans, arguments.seed) for folder in arguments.folders]
    print_table(labels, found)
    if arguments.out:
        draw(labels, found, arguments.out)


if __name__ == "__main__":
    main()
