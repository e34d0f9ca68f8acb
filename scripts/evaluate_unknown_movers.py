#!/usr/bin/env python3
"""Compares unknown_movers.csv of a run with the true objects of a simulated drive: how many of the reported things are
at an object that moves, and how far their velocities are off."""

import argparse
import collections
import csv
import math
import statistics

MIN_SPEED_MPS = 0.3
REACH_M = 1.5  # beyond half of the object's length


def read(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def moving_objects(rows):
    by_frame = collections.defaultdict(list)
    for row in rows:
        velocity = float(row["vx_mps"]), float(row["vy_mps"])
        if math.hypot(*velocity) > MIN_SPEED_MPS:
            by_frame[int(row["frame"])].append(
                (float(row["x_m"]), float(row["y_m"]), 0.5 * float(row["length_m"]), velocity))
    return by_frame


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--truth", required=True, help="truth/objects.csv of the simulated drive")
    parser.add_argument("--estimate", required=True, help="unknown_movers.csv of the run")
    options = parser.parse_args()

    truth = moving_objects(read(options.truth))
    reported = read(options.estimate)
    errors = []
    for row in reported:
        x, y = float(row["x_m"]), float(row["y_m"])
        near = [(math.hypot(tx - x, ty - y), velocity) for tx, ty, half, velocity in truth[int(row["frame"])]
                if math.hypot(tx - x, ty - y) < half + REACH_M]
        if near:
            velocity = min(near)[1]
            difference = math.hypot(velocity[0] - float(row["vx_mps"]), velocity[1] - float(row["vy_mps"]))
            errors.append(difference / math.hypot(*velocity))
    print(f"reported {len(reported)}, at an object that moves {len(errors)}")
    if errors:
        within = sum(error < 0.3 for error in errors) / len(errors)
        print(f"velocity off by {100 * statistics.median(errors):.0f} % (median), by less than 30 % in {100 * within:.0f} %")


if __name__ == "__main__":
    main()
