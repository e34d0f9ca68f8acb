#!/usr/bin/python3
"""Runs `mlo run` with detections and judges the trajectories of objects by `mlo eval objects`.

Cases are drive 0005 of KITTI (tracking sequence 0000) with the boxes of two detectors, and simulated drives with the
boxes of the simulated one; variants are arguments of `mlo run`, by default the three modes of the motion estimate.
Only true objects with at least 20 frames that were to be tracked count. Prints, and writes to OUT/objects.md, a table
of means by variant and case, and the objects of the first variant one by one; the numbers go to OUT/objects.json.

ROOT holds kitti_tracking/training and truth_lidar. A drive that is in OUT already is not simulated again.
"""

import argparse
import collections
import csv
import json
import sys
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean

from evaluate_sequences import markdown, parse_variant, run_mlo

MIN_FRAMES = 20
MEASURES = ["ate_m", "rte_m_per_m", "rre_deg_per_m"]
LENGTHS_M = {"city": 120, "jam": 40, "highway": 300}
MAX_SCANS = 150  # of a simulated drive
DETECTORS = {"0005 PointRCNN": ["pointrcnn_car", "pointrcnn_pedestrian", "pointrcnn_cyclist"],
             "0005 Point-GNN": ["pointgnn_car"]}
CLASSES = {"0005 Point-GNN": ["car", "van"]}  # of truth, where the detector does not know all
DEFAULT_VARIANTS = ["fusion:", "semantic: --set tracking.sgf.mode=semantic",
                    "geometry: --set tracking.sgf.mode=geometry"]


@dataclass(frozen=True)
class Case:
    run: list  # arguments of `mlo run`
    truth: list  # arguments of `mlo eval objects`


def kitti_case(data, name):
    training = data / "kitti_tracking" / "training"
    boxes = [str(training / "detections" / folder) for folder in DETECTORS[name]]
    truth = ["--truth", str(training / "label_02" / "0000.txt"), "--calib", str(training / "calib" / "0000.txt"),
             "--truth-poses", str(data / "truth_lidar" / "0005_vel.txt")]
    classes = ["--class", *CLASSES[name]] if name in CLASSES else []
    return Case([str(training), "--sequence", "0000", "--detections", *boxes], truth + classes)


def simulated_case(options, scene):
    drive = options.out / "drives" / f"{scene}_{options.seed}"
    if not (drive / "truth" / "static_map.ply").is_file():  # written last
        run_mlo(options.program, ["simulate", "--scene", scene, "--length", str(LENGTHS_M[scene]),
                                  "--scans", str(MAX_SCANS), "--seed", str(options.seed), "--overwrite",
                                  "--out", str(drive)])
    return Case([str(drive), "--detections", str(drive / "detections" / "noisy.csv")],
                ["--truth", str(drive / "truth" / "objects.csv")])


def motion_statuses(table):
    """How often the motion estimate of a reported object ended how."""
    with open(table, newline="", encoding="utf-8") as file:
        return collections.Counter(row["motion_status"] for row in csv.DictReader(file))


def measure(program, case, variant, out):
    run_mlo(program, ["run", *case.run, "--out", str(out), *variant.arguments])
    found = json.loads(run_mlo(program, ["eval", "objects", "--json", "--estimate", str(out / "objects.csv"),
                                         *case.truth]))
    objects = [row for row in found["objects"] if row["truth_frames"] >= MIN_FRAMES]
    tracking = json.loads((out / "run.json").read_text(encoding="utf-8"))["times"].get("tracking", {})
    return {"objects": objects, "statuses": motion_statuses(out / "objects.csv"), "times": tracking}


def mean_of(objects, measure_name):
    values = [row[measure_name] for row in objects if row[measure_name] is not None]
    return f"{fmean(values):.3f}" if values else "-"


def summary_cells(result):
    objects, statuses = result["objects"], result["statuses"]
    lost = sum(row["track"] is None for row in objects)
    failed = statuses["degenerate"] + statuses["too_few_matches"]
    return [f"{len(objects)}", f"{lost}", f"{sum(row['switches'] for row in objects)}",
            *(mean_of(objects, name) for name in MEASURES), f"{failed} of {sum(statuses.values())}"]


def object_cells(row):
    def text(value):
        return "-" if value is None else f"{value:.3f}"

    track = "lost" if row["track"] is None else str(row["track"])
    return [f"{row['id']}", row["class"], track, f"{row['tracked_frames']} of {row['truth_frames']}",
            f"{row['path_m']:.1f}", *(text(row[name]) for name in MEASURES)]


SUMMARY_HEADER = ["case", "variant", "objects", "lost", "switches", "ATE [m]", "RTE [m/m]", "RRE [deg/m]",
                  "failed estimates"]
OBJECT_HEADER = ["object", "class", "track", "frames", "path [m]", "ATE [m]", "RTE [m/m]", "RRE [deg/m]"]


def report_text(results):
    rows = [[case, variant, *summary_cells(result)]
            for case, by_variant in results.items() for variant, result in by_variant.items()]
    parts = [markdown(SUMMARY_HEADER, rows)]
    for case, by_variant in results.items():
        variant, result = next(iter(by_variant.items()))
        parts += [f"{case}, {variant}:", markdown(OBJECT_HEADER, [object_cells(row) for row in result["objects"]])]
    return "\n\n".join(parts) + "\n"


def arguments():
    cases = [*DETECTORS, *LENGTHS_M]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, metavar="ROOT", help="KITTI; without it, only the simulated drives")
    parser.add_argument("--program", default="build/bin/mlo")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--seed", type=int, default=7, help="of the simulated drives")
    parser.add_argument("--case", action="append", choices=cases, help="only this one; may be repeated")
    parser.add_argument("--variant", type=parse_variant, action="append", metavar="'NAME: ARGUMENTS'",
                        help="may be repeated; by default: " + "; ".join(DEFAULT_VARIANTS))
    return parser.parse_args()


def main():
    options = arguments()
    variants = options.variant or [parse_variant(text) for text in DEFAULT_VARIANTS]
    names = options.case or [*(DETECTORS if options.data else []), *LENGTHS_M]
    if not options.data and any(name in DETECTORS for name in names):
        sys.exit("drive 0005 needs --data")
    results = {}
    for name in names:
        case = kitti_case(options.data, name) if name in DETECTORS else simulated_case(options, name)
        results[name] = {}
        for variant in variants:
            print(f"{name}, {variant.name}", file=sys.stderr, flush=True)
            out = options.out / "runs" / name.replace(" ", "_") / variant.folder
            results[name][variant.name] = measure(options.program, case, variant, out)
            (options.out / "objects.json").write_text(json.dumps(results, indent=1), encoding="utf-8")
    text = report_text(results)
    (options.out / "objects.md").write_text(text, encoding="utf-8")
    print(text, end="")


if __name__ == "__main__":
    main()
