#!/usr/bin/env python3
"""Compares, scan by scan, which objects move by a run and by a simulated drive's truth.

Each object of the truth with enough points is paired with the nearest reported one within 2 m. Prints true and
false decisions and the F1 score of 'moving', and the share of scans with the decision 'moving' by true speed.

Example:
  mlo simulate --scene parking --length 120 --seed 7 --out out/parking
  mlo run out/parking --detections out/parking/detections/noisy.csv --out out/parking_run
  scripts/evaluate_motion_decisions.py --truth out/parking/truth/objects.csv --estimate out/parking_run/objects.csv
"""
import argparse
import collections
import csv
import math

PAIRED_WITHIN_M = 2.0
SPEED_STEP_MPS = 0.25


def rows_by_frame(path):
    rows = collections.defaultdict(list)
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            row["place"] = float(row["x_m"]), float(row["y_m"])
            rows[int(row["frame"])].append(row)
    return rows


def decisions(truth, estimate, min_points):
    """Yields (truly moving, decided moving, true speed [m/s]) for each object and scan, or None if not found."""
    for frame, objects in truth.items():
        for true in objects:
            if int(true["points"]) < min_points:
                continue
            near = min(estimate[frame], key=lambda e: math.dist(e["place"], true["place"]), default=None)
            if near is None or math.dist(near["place"], true["place"]) > PAIRED_WITHIN_M:
                yield None
                continue
            speed = math.hypot(float(true["vx_mps"]), float(true["vy_mps"]))
            yield true["state"] == "moving", near["state"] == "moving", speed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--truth", required=True, help="truth/objects.csv of a simulated drive")
    parser.add_argument("--estimate", required=True, help="objects.csv of a run")
    parser.add_argument("--min-points", type=int, default=10, help="objects with fewer returns do not count")
    args = parser.parse_args()

    estimate = rows_by_frame(args.estimate)
    last_frame = max(estimate, default=-1)
    truth = {frame: rows for frame, rows in rows_by_frame(args.truth).items() if frame <= last_frame}
    found = list(decisions(truth, estimate, args.min_points))
    known = [d for d in found if d is not None]
    counts = collections.Counter((true, decided) for true, decided, _ in known)
    hits, false_alarms, misses = counts[True, True], counts[False, True], counts[True, False]
    f1 = 2 * hits / max(1, 2 * hits + false_alarms + misses)
    print(f"moving: {hits} found, {misses} missed; at rest: {counts[False, False]} found, "
          f"{false_alarms} taken for moving; {len(found) - len(known)} not tracked")
    print(f"F1 {f1:.3f}")
    by_speed = collections.defaultdict(list)
    for true, decided, speed in known:
        if true:
            by_speed[int(speed / SPEED_STEP_MPS)].append(decided)
    for step in sorted(by_speed):
        share = sum(by_speed[step]) / len(by_speed[step])
        print(f"  {step * SPEED_STEP_MPS:5.2f} m/s and up: {share:6.1%} of {len(by_speed[step])}")


if __name__ == "__main__":
    main()
