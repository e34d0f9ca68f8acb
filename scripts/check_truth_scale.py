#!/usr/bin/python3
"""Whose scale is it? Compares the length of a KITTI raw drive by three accounts.

The truth integrates the velocity of the oxts unit; the same unit also gives positions (here by KITTI's Mercator
projection, moved to the lidar); the estimate knows the lidar only. Prints chord and path length by each, how accurate
the unit states itself to be, and the ATE before and after a scale is fitted. Positions say something about the scale
only where their stated accuracy is small against the differences.
"""

import argparse
from pathlib import Path

import numpy as np

EARTH_RADIUS_M = 6378137.0
ROLL, PITCH, YAW, NORTH_VELOCITY, EAST_VELOCITY = 3, 4, 5, 6, 7
POSITION_ACCURACY, VELOCITY_ACCURACY = 23, 24


def read_positions(path):
    return np.loadtxt(path, ndmin=2).reshape(-1, 3, 4)[:, :, 3]


def read_oxts(folder, count):
    """The records of the first `count` scans, a row each."""
    return np.array([np.loadtxt(folder / f"{frame:010d}.txt") for frame in range(count)])


def lidar_in_imu(calibration):
    """Origin of the lidar in the IMU's frame [m], from calib_imu_to_velo.txt, which holds T_lidar_imu."""
    rows = dict(line.split(":", 1) for line in calibration.read_text(encoding="utf-8").splitlines() if ":" in line)
    rotation = np.array(rows["R"].split(), float).reshape(3, 3)
    return -rotation.T @ np.array(rows["T"].split(), float)


def rotation(roll, pitch, yaw):
    cos_x, cos_y, cos_z = np.cos([roll, pitch, yaw])
    sin_x, sin_y, sin_z = np.sin([roll, pitch, yaw])
    about_x = np.array([[1, 0, 0], [0, cos_x, -sin_x], [0, sin_x, cos_x]])
    about_y = np.array([[cos_y, 0, sin_y], [0, 1, 0], [-sin_y, 0, cos_y]])
    about_z = np.array([[cos_z, -sin_z, 0], [sin_z, cos_z, 0], [0, 0, 1]])
    return about_z @ about_y @ about_x


def oxts_positions(records, p_imu_lidar):
    """Positions of the lidar by the unit's latitude, longitude and altitude, as KITTI's development kit has them."""
    latitude, longitude = records[:, 0], records[:, 1]
    scale = np.cos(np.radians(latitude[0])) * EARTH_RADIUS_M
    p_world_imu = np.stack([scale * np.radians(longitude),
                            scale * np.log(np.tan(np.radians(90.0 + latitude) / 2.0)), records[:, 2]], axis=1)
    levers = np.array([rotation(*record[[ROLL, PITCH, YAW]]) @ p_imu_lidar for record in records])
    return p_world_imu + levers


def align(points, target, with_scale):
    """(scale, RMS distance) after the similarity or rigid motion that fits best (Umeyama 1991)."""
    points, target = points - points.mean(axis=0), target - target.mean(axis=0)
    u, singular, vt = np.linalg.svd(target.T @ points)
    signs = np.array([1.0, 1.0, np.linalg.det(u) * np.linalg.det(vt)])
    scale = (singular @ signs) / np.sum(points**2) if with_scale else 1.0
    moved = scale * points @ (u @ np.diag(signs) @ vt).T
    return scale, np.sqrt(np.mean(np.sum((moved - target) ** 2, axis=1)))


def chord(positions):
    return np.linalg.norm(positions[-1] - positions[0])



def path_length(positions):
    return np.linalg.norm(np.diff(positions, axis=0), axis=1).sum()


def relative(value, reference):
    return f"{value:.3f} m ({100 * (value / reference - 1):+.2f} %)"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("drive", type=Path, help="..._drive_NNNN_sync, with calib_imu_to_velo.txt beside it")
    parser.add_argument("--truth", type=Path, required=True, help="lidar poses by integrated velocity, KITTI rows")
    parser.add_argument("--estimate", type=Path, required=True, help="trajectory.txt of the same scans")
    options = parser.parse_args()

    truth, estimate = read_positions(options.truth), read_positions(options.estimate)
    count = min(len(truth), len(estimate))
    truth, estimate = truth[:count], estimate[:count]
    records = read_oxts(options.drive / "oxts" / "data", count)
    oxts = oxts_positions(records, lidar_in_imu(options.drive.parent / "calib_imu_to_velo.txt"))
    print(f"{options.drive.name}, scans 0 to {count - 1}")
    for name, positions in [("truth, integrated oxts velocity", truth), ("oxts positions", oxts),
                            ("estimate", estimate)]:
        print(f"  {name:31} chord {relative(chord(positions), chord(truth))}, "
              f"path {relative(path_length(positions), path_length(truth))}")
    speed = np.hypot(records[:, NORTH_VELOCITY], records[:, EAST_VELOCITY]).mean()
    accuracy = records[:, VELOCITY_ACCURACY].mean()
    print(f"  stated accuracy of the positions {records[:, POSITION_ACCURACY].mean():.3f} m")
    print(f"  stated accuracy of the velocity {accuracy:.3f} m/s at {speed:.2f} m/s: {100 * accuracy / speed:.2f} %")
    for name, target in [("truth", truth), ("oxts positions", oxts)]:
        scale, scaled = align(estimate, target, with_scale=True)
        _, rigid = align(estimate, target, with_scale=False)
        print(f"  ATE against {name}: {rigid:.3f} m; with the estimate scaled by {scale:.5f}: {scaled:.3f} m")


if __name__ == "__main__":
    main()
