#!/usr/bin/env python3
"""Localises in maps of earlier runs, from starts that are off at random, and compares with the runs that made the maps.

  scripts/evaluate_localisation.py --out out/localisation --drives sequences/04 2011_09_26_drive_0005_sync ...
"""
import argparse
import csv
import math
import pathlib
import random
import subprocess

import numpy

FOUND_AFTER = 10  # scans
NEAR_M = 0.1


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="build/bin/mlo")
    parser.add_argument("--drives", nargs="+", required=True, type=pathlib.Path, help="folders of scans")
    parser.add_argument("--starts", type=int, default=10, help="in each drive")
    parser.add_argument("--scans", type=int, default=20, help="after each start")
    parser.add_argument("--radius", type=float, default=5.0, help="how far off a start is at most [m]")
    parser.add_argument("--yaw", type=float, default=15.0, help="and its heading [deg]")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", required=True, type=pathlib.Path)
    return parser.parse_args()


def run(arguments, drive, out, *more):
    words = [arguments.program, "-q", "run", drive, "--detector", "none", "--out", out, *more]
    subprocess.run([str(word) for word in words], check=True, stdout=subprocess.DEVNULL)
    return numpy.loadtxt(out / "trajectory.txt").reshape(-1, 3, 4)


def rows_of(file):
    with open(file, newline="") as stream:
        return list(csv.DictReader(stream))


def start_beside(pose, arguments):
    """A pose as --start has it, off by a random way and turn."""
    distance, direction = arguments.radius * math.sqrt(random.random()), random.uniform(-math.pi, math.pi)
    yaw = math.degrees(math.atan2(pose[1, 0], pose[0, 0])) + random.uniform(-arguments.yaw, arguments.yaw)
    x, y, z = pose[:, 3] + distance * numpy.array([math.cos(direction), math.sin(direction), 0.0])
    return f"--start={x:.3f},{y:.3f},{z:.3f},{yaw:.3f}"


def localise(arguments, drive, frames, mapped, folder):
    """Distances to the mapping run; infinite for scans that were not found in the map."""
    first = random.randrange(len(mapped) - arguments.scans + 1)
    found = run(arguments, drive, folder / "again", "--map", folder / "map/scene.mlo",
                start_beside(mapped[first], arguments), "--frames",
                f"{frames[first]}:{frames[first + arguments.scans - 1]}")
    differences = numpy.linalg.norm(found[:, :, 3] - mapped[first:first + len(found), :, 3], axis=1)
    states = [row["status"] for row in rows_of(folder / "again/per_scan.csv")]
    return numpy.where([state == "localised" for state in states], differences, math.inf)


def evaluate(arguments, drive):
    folder = arguments.out / drive.name
    mapped = run(arguments, drive, folder / "map")
    frames = [int(row["frame"]) for row in rows_of(folder / "map/per_scan.csv")]
    starts = [localise(arguments, drive, frames, mapped, folder) for _ in range(arguments.starts)]
    # The first pose is found before the motion, and so the distortion of the scan, is known.
    within = [numpy.flatnonzero(differences > NEAR_M).max(initial=-1) + 2 for differences in starts]
    later = numpy.concatenate([differences[FOUND_AFTER:] for differences in starts])
    print(f"| {drive.name} | {sum(scans <= FOUND_AFTER for scans in within)} of {len(starts)} | {max(within)} | "
          f"{numpy.median(later):.3f} | {later.max():.3f} |", flush=True)


def main():
    arguments = parse_arguments()
    random.seed(arguments.seed)
    print(f"| drive | found within {FOUND_AFTER} scans | scans until within {NEAR_M} m for good, at most | "
          "then median distance [m] | largest [m] |\n| --- | --- | --- | --- | --- |", flush=True)
    for drive in arguments.drives:
        evaluate(arguments, drive)


if __name__ == "__main__":
    main()
