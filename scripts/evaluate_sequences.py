#!/usr/bin/python3
"""Runs `mlo run` and `mlo eval trajectory` on four KITTI extracts with several configurations.

Prints, and writes to OUT/results.md, one table of errors and speed by variant and sequence, and one of the time of
each stage by sequence. The numbers behind it go to OUT/results.json. No objects are looked for, unless a variant says
so (--set detection.detector=cluster).

ROOT holds kitti_odometry, kitti_raw and truth_lidar; OUT/<variant>/<sequence> becomes the folder of each run.
"""

import argparse
import csv
import json
import os
import re
import shlex
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

DATE = "2011_09_26"


@dataclass(frozen=True)
class Sequence:
    name: str
    folder: str  # below ROOT
    truth: str  # below ROOT


SEQUENCES = [
    Sequence("01", "kitti_odometry/sequences/01", "truth_lidar/01.txt"),
    Sequence("04", "kitti_odometry/sequences/04", "truth_lidar/04.txt"),
    Sequence("0005", f"kitti_raw/{DATE}/{DATE}_drive_0005_sync", "truth_lidar/0005_vel.txt"),
    Sequence("0009", f"kitti_raw/{DATE}/{DATE}_drive_0009_sync", "truth_lidar/0009_vel.txt"),
]

DEFAULT_VARIANTS = [
    "default:",
    "cropped: --roi camera",
    "MLO-gc: --set odometry.consistency_check=false",
    "cropped, MLO-gc: --roi camera --set odometry.consistency_check=false",
    "no vertical correction: --set sensor.vertical_correction_deg=0",
    "cropped, no vertical correction: --roi camera --set sensor.vertical_correction_deg=0",
    "constant motion only: --set odometry.enabled=false",
    "paper: --preset paper",
    "paper, middle of the sweep: --preset paper --set motion.reference_fraction=0.5",
    "paper, cropped: --preset paper --roi camera",
]


@dataclass(frozen=True)
class Variant:
    name: str
    arguments: list

    @property
    def folder(self):
        return re.sub(r"[^a-z0-9]+", "_", self.name.lower()).strip("_")


def parse_variant(text):
    name, colon, arguments = text.partition(":")
    if not colon or not name.strip():
        raise argparse.ArgumentTypeError(f"'{text}' is not 'name: mlo run arguments'")
    return Variant(name.strip(), shlex.split(arguments))


def run_mlo(program, arguments):
    """Returns stdout; a failure is a result to be reported, so it comes back as an error."""
    done = subprocess.run([program, "--quiet", *arguments], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(done.stderr.strip() or f"exit code {done.returncode}")
    return done.stdout


def scan_status(path):
    """How many scans there were, and of how many the pose is a prediction only (skipped ones too)."""
    with open(path, newline="", encoding="utf-8") as file:
        statuses = [row["status"] for row in csv.DictReader(file)]
    return {"lost": sum(status not in ("first", "localised") for status in statuses), "scans": len(statuses)}


def measure(program, data, sequence, variant, out):
    """One run with its errors: the numbers of one cell of the table."""
    run_mlo(program, ["run", str(data / sequence.folder), "--out", str(out), "--set", "detection.detector=none",
                      *variant.arguments])
    errors = json.loads(run_mlo(program, ["eval", "trajectory", "--json", "--truth", str(data / sequence.truth),
                                          "--estimate", str(out / "trajectory.txt")]))["estimates"][0]
    report = json.loads((out / "run.json").read_text(encoding="utf-8"))
    return {
        "ate_m": errors["ate_m"],
        "rte_m_per_frame": errors["rte_m_per_frame"],
        "rre_deg_per_frame": errors["rre_deg_per_frame"],
        "times": report["times"],
        "peak_mib": report["peak_memory_mib"],
        **scan_status(out / "per_scan.csv"),
    }


def markdown(header, rows):
    lines = ["| " + " | ".join(header) + " |", "| " + " | ".join("---" for _ in header) + " |"]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def cell(result):
    if "error" in result:
        return "failed"
    scan = result["times"]["scan"]
    errors = f"{result['ate_m']:.3f} / {result['rte_m_per_frame']:.4f} / {result['rre_deg_per_frame']:.4f}"
    return f"{errors}; {scan['mean_ms']:.0f}, {scan['p99_ms']:.0f} ms; {result['peak_mib']:.0f} MiB; {result['lost']}"


def error_table(results, sequences):
    names = [sequence.name for sequence in sequences]
    rows = [[variant, *(cell(by_sequence[name]) for name in names)] for variant, by_sequence in results.items()]
    return markdown(["variant", *names], rows)


def stage_table(by_sequence):
    """p50 and p99 of each stage [ms]; a sequence is a row."""
    measured = {name: result["times"] for name, result in by_sequence.items() if "times" in result}
    stages = list(next(iter(measured.values()), {}))
    rows = [[name, *(f"{times[stage]['p50_ms']:.1f} / {times[stage]['p99_ms']:.1f}" for stage in stages)]
            for name, times in measured.items()]
    return markdown(["sequence", *stages], rows)


def load_note():
    """Times on a machine that does other things too say little; the reader should know."""
    load, cores = os.getloadavg()[0], os.cpu_count()
    note = f"Measured on {cores} cores; load at the end {load:.1f}."
    return note + (" Other programs ran at the same time: times are upper bounds." if load > 1.5 * cores else "")


def report_text(results, sequences):
    parts = ["ATE [m] / mean RTE [m/frame] / mean RRE [deg/frame]; ms per scan, mean and p99; peak memory; "
             "scans without a pose of their own (predicted or skipped).",
             error_table(results, sequences)]
    for variant, by_sequence in results.items():
        parts += [f"Stages of '{variant}', p50 / p99 [ms]:", stage_table(by_sequence)]
    parts += [f"{variant}, {name}: {result['error']}" for variant, by_sequence in results.items()
              for name, result in by_sequence.items() if "error" in result]
    return "\n\n".join([*parts, load_note()]) + "\n"


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, required=True, metavar="ROOT")
    parser.add_argument("--program", default="build/bin/mlo")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--variant", type=parse_variant, action="append", metavar="'NAME: ARGUMENTS'",
                        help="may be repeated; by default: " + "; ".join(DEFAULT_VARIANTS))
    parser.add_argument("--sequence", action="append", choices=[sequence.name for sequence in SEQUENCES],
                        help="only this one; may be repeated")
    return parser.parse_args()


def main():
    options = arguments()
    variants = options.variant or [parse_variant(text) for text in DEFAULT_VARIANTS]
    sequences = [sequence for sequence in SEQUENCES if not options.sequence or sequence.name in options.sequence]
    missing = [sequence.truth for sequence in sequences if not (options.data / sequence.truth).is_file()]
    if missing:
        sys.exit(f"{options.data} lacks {', '.join(missing)}; --data wants the folder that holds truth_lidar")
    results = {}
    for variant in variants:
        results[variant.name] = {}
        for sequence in sequences:
            print(f"{variant.name}, {sequence.name}", file=sys.stderr, flush=True)
            out = options.out / variant.folder / sequence.name
            try:
                result = measure(options.program, options.data, sequence, variant, out)
            except RuntimeError as error:
                result = {"error": str(error)}
            results[variant.name][sequence.name] = result
            options.out.mkdir(parents=True, exist_ok=True)
            (options.out / "results.json").write_text(json.dumps(results, indent=1), encoding="utf-8")
    text = report_text(results, sequences)
    (options.out / "results.md").write_text(text, encoding="utf-8")
    print(text, end="")
    return any("error" in result for by_sequence in results.values() for result in by_sequence.values())


if __name__ == "__main__":
    sys.exit(main())
