#!/usr/bin/python3
"""Which poses do the scans themselves agree with? Needs no estimator: places pairs of scans by each file of poses.

For pairs of scans some frames apart, points of the later scan are placed in the earlier one by the relative pose, and
their distances to planes of the earlier scan are taken, on surfaces that face the direction of travel (those tell how
far the robot went; along the others it slides). Prints the RMS distance by the poses as they are, and the factor of
their translation at which it is smallest: 1 where poses and scans have the same scale. Distances are cut at 0.15 m,
so that what moves does not decide.
"""

import argparse
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

SCALES = np.arange(0.988, 1.01201, 0.002)
CUT_M = 0.15
VERTICAL_CORRECTION_RAD = np.radians(0.205)


def read_poses(path):
    rows = np.loadtxt(path, ndmin=2).reshape(-1, 3, 4)
    poses = np.tile(np.eye(4), (len(rows), 1, 1))
    poses[:, :3] = rows
    return poses


def correct_elevations(points):
    horizontal, distance = np.linalg.norm(points[:, :2], axis=1), np.linalg.norm(points, axis=1)
    elevation = np.arctan2(points[:, 2], horizontal) + VERTICAL_CORRECTION_RAD
    flat = points[:, :2] * (distance * np.cos(elevation) / horizontal)[:, None]
    return np.column_stack([flat, distance * np.sin(elevation)])


def undistort(points, motion):
    """To the middle of a sweep that starts behind the car and runs clockwise, by the motion [4, 4] per sweep."""
    share = -0.5 * np.arctan2(points[:, 1], points[:, 0]) / np.pi
    turn = 0.5 * np.array([motion[2, 1] - motion[1, 2], motion[0, 2] - motion[2, 0], motion[1, 0] - motion[0, 1]])
    return points + share[:, None] * (motion[:3, 3] + np.cross(turn, points))


def read_scan(path, motion):
    points = np.fromfile(path, np.float32).reshape(-1, 4)[:, :3].astype(float)
    distance = np.linalg.norm(points, axis=1)
    points = correct_elevations(points[(distance > 3.0) & (distance < 60.0)])
    return points if motion is None else undistort(points, motion)


def find_planes(points):
    """Tree, normals, centres, and which points have a plane around them."""
    tree = cKDTree(points)
    distance, index = tree.query(points, k=12)
    around = points[index]
    centre = around.mean(axis=1, keepdims=True)
    covariance = np.einsum("nki,nkj->nij", around - centre, around - centre) / 12
    variance, axes = np.linalg.eigh(covariance)
    flat = (variance[:, 0] < 0.02**2) & (variance[:, 0] < 0.02 * variance[:, 1])
    sheet = variance[:, 1] > 0.1 * variance[:, 2]
    return tree, axes[:, :, 0], centre[:, 0], flat & sheet & (distance[:, -1] < 0.6)


def squared_distances(earlier, later, T_earlier_later):
    """For each scale and point of the later scan, with the points that met a plane at any scale."""
    tree, normals, centres, is_plane = find_planes(earlier)
    travelled = T_earlier_later[:3, 3]
    facing = is_plane & (np.abs(normals @ travelled) > 0.5 * np.linalg.norm(travelled))
    squared = np.full((len(SCALES), len(later)), CUT_M**2)
    for row, scale in zip(squared, SCALES):
        placed = later @ T_earlier_later[:3, :3].T + scale * travelled
        distance, index = tree.query(placed, distance_upper_bound=0.5)
        met = np.flatnonzero(np.isfinite(distance))
        met = met[facing[index[met]]]
        nearest = index[met]
        residual = np.einsum("ij,ij->i", normals[nearest], placed[met] - centres[nearest])
        row[met] = np.minimum(residual**2, CUT_M**2)
    return squared[:, (squared < CUT_M**2).any(axis=0)]


def best_scale(rms):
    """Of the parabola through the smallest value and its neighbours; None at the rim."""
    i = int(rms.argmin())
    if i in (0, len(rms) - 1):
        return None
    before, least, after = rms[i - 1:i + 2]
    return SCALES[i] + 0.5 * (SCALES[1] - SCALES[0]) * (before - after) / (before - 2 * least + after)


def compare(poses, scans, gap, compensated):
    sums, count = np.zeros(len(SCALES)), 0
    for i in range(1, min(len(poses), len(scans)) - gap, max(1, gap // 2)):
        relative = np.linalg.inv(poses[i]) @ poses[i + gap]
        if np.linalg.norm(relative[:3, 3]) < 2.0:
            continue
        earlier, later = (read_scan(scans[k], None if compensated else np.linalg.inv(poses[k - 1]) @ poses[k])
                          for k in (i, i + gap))
        squared = squared_distances(earlier, later[::3], relative)
        sums += squared.sum(axis=1)
        count += squared.shape[1]
    return np.sqrt(sums / max(count, 1)), count


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scans", type=Path, help="folder of KITTI .bin scans")
    parser.add_argument("--poses", type=Path, action="append", required=True,
                        help="poses of the lidar as KITTI rows, one for each scan; may be repeated")
    parser.add_argument("--compensated", action="store_true", help="the scans are motion-compensated (KITTI odometry)")
    parser.add_argument("--gaps", type=int, nargs="+", default=[5, 10, 20], help="frames between the scans of a pair")
    options = parser.parse_args()

    scans = sorted(options.scans.glob("*.bin"))
    for path in options.poses:
        poses = read_poses(path)
        for gap in options.gaps:
            rms, count = compare(poses, scans, gap, options.compensated)
            scale = best_scale(rms) if count else None
            as_is = 1000 * rms[np.abs(SCALES - 1.0).argmin()]
            found = "beyond what was tried" if scale is None else f"{scale:.4f}, {1000 * rms.min():.1f} mm"
            print(f"{path.name:20} {gap:3} frames apart: {as_is:6.1f} mm, best scale {found} ({count} points)")


if __name__ == "__main__":
    main()
