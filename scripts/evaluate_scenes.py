#!/usr/bin/python3
"""Simulates drives through all scenes, runs `mlo run` on them and measures the errors against the exact truth.

Each scene is run with the simulated detector's boxes (detections/noisy.csv), with and without the consistency check
of the odometry. Prints, and writes to OUT/scenes.md, a table with the errors of the refined trajectory and of the
scan-to-scan odometry, and how many scans said that the scene left a direction open (status `degenerate`). A drive
that is in OUT already is not simulated again.
"""

import argparse
import csv
import json
import sys
from pathlib import Path

from evaluate_sequences import load_note, markdown, parse_variant, run_mlo

LENGTHS_M = {"city": 300, "suburb": 300, "highway": 600, "tunnel": 400, "train": 300, "jam": 40, "parking": 180}
DEFAULT_VARIANTS = ["default:", "no check: --set odometry.consistency_check=false"]


def simulate(options, scene):
    drive = options.out / "drives" / f"{scene}_{options.seed}"
    if not (drive / "truth" / "static_map.ply").is_file():  # written last
        run_mlo(options.program, ["simulate", "--scene", scene, "--length", str(options.length or LENGTHS_M[scene]),
                                  "--seed", str(options.seed), "--overwrite", "--out", str(drive)])
    return drive


def errors(options, drive, estimate):
    found = json.loads(run_mlo(options.program, ["eval", "trajectory", "--json", "--estimate", str(estimate),
                                                 "--truth", str(drive / "truth" / "poses_stamp.txt")]))
    return found["estimates"][0]


def measure(options, scene, variant):
    """The numbers of one row."""
    drive = simulate(options, scene)
    out = options.out / "runs" / f"{scene}_{options.seed}_{variant.folder}"
    run_mlo(options.program, ["run", str(drive), "--out", str(out), "--detections",
                              str(drive / "detections" / "noisy.csv"), *variant.arguments])
    with open(out / "per_scan.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return {
        "scans": len(rows),
        "predicted": sum(row["status"] not in ("first", "localised") for row in rows),
        "degenerate_odometry": sum(row["odometry_status"] == "degenerate" for row in rows),
        "degenerate_refinement": sum(row["refinement_status"] == "degenerate" for row in rows),
        "trajectory": errors(options, drive, out / "trajectory.txt"),
        "odometry": errors(options, drive, out / "odometry.txt"),
    }


def cells(scene, variant, result):
    def triple(found):
        return f"{found['ate_m']:.3f} / {found['rte_m_per_frame']:.4f} / {found['rre_deg_per_frame']:.4f}"

    return [f"{scene}, {variant}", f"{result['trajectory']['truth_path_m']:.0f} m, {result['scans']}",
            triple(result["trajectory"]), triple(result["odometry"]),
            f"{result['degenerate_odometry']} / {result['degenerate_refinement']}", str(result["predicted"])]


HEADER = ["scene, variant", "path, scans", "trajectory: ATE [m] / RTE [m/frame] / RRE [deg/frame]",
          "odometry alone", "scans degenerate, odometry / refinement", "predicted"]


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="build/bin/mlo")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--seed", type=int, default=7)
    parser.add_argument("--length", type=float, help="of all drives [m]; by default each scene has its own")
    parser.add_argument("--scene", action="append", choices=list(LENGTHS_M), help="only this one; may be repeated")
    parser.add_argument("--variant", type=parse_variant, action="append", metavar="'NAME: ARGUMENTS'",
                        help="may be repeated; by default: " + "; ".join(DEFAULT_VARIANTS))
    return parser.parse_args()


def main():
    options = arguments()
    variants = options.variant or [parse_variant(text) for text in DEFAULT_VARIANTS]
    rows, results = [], {}
    for scene in options.scene or LENGTHS_M:
        for variant in variants:
            print(f"{scene}, {variant.name}", file=sys.stderr, flush=True)
            result = measure(options, scene, variant)
            results[f"{scene}, {variant.name}"] = result
            rows.append(cells(scene, variant.name, result))
    text = markdown(HEADER, rows) + "\n"
    options.out.mkdir(parents=True, exist_ok=True)
    (options.out / "scenes.md").write_text(text, encoding="utf-8")
    (options.out / "scenes.json").write_text(json.dumps(results, indent=1), encoding="utf-8")
    print(text + "\n" + load_note())


if __name__ == "__main__":
    main()
