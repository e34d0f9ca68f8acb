#!/usr/bin/python3
"""Measures the detectors of `mlo run`: average precision, and what they do to trajectories and tracks.

On simulated drives that no model was fitted on (seeds 7 and 8), boxes are judged all round by the exact truth, and the
trajectories of runs with and without each detector by the true poses. On real data, ROOT holds kitti_tracking/training,
kitti_odometry, kitti_raw and truth_lidar: boxes on drive 0005 (tracking sequence 0000) are judged by its labels, beside
published PointRCNN boxes, with the tracks made of them; trajectories on the four extracts. Prints tables, and writes
them to OUT/detectors.md. Drives that are in OUT already are not simulated again.
"""

import argparse
import json
from pathlib import Path

from evaluate_sequences import SEQUENCES, markdown, run_mlo

SCENES = ["city", "suburb", "highway", "jam", "parking"]
SEEDS = [7, 8]
SCANS = 100
CLASSES = ["car", "van", "truck", "pedestrian", "cyclist"]
LABELLED = ["car", "pedestrian", "cyclist"]
# Far below what is reported, so that recall can grow as the threshold falls.
ALL_BOXES = {"cluster": ["--set", "detection.cluster.min_probability=0", "--set", "detection.cluster.min_candidate=0.02"],
             "3dssd": ["--set", "detection.network.min_confidence=0", "--set", "detection.network.min_candidate=0.02"]}


def simulate(options, scene, seed):
    drive = options.out / "drives" / f"{scene}_{seed}"
    if not (drive / "truth" / "static_map.ply").is_file():  # written last
        run_mlo(options.program, ["simulate", "--scene", scene, "--length", "120", "--scans", str(SCANS), "--seed",
                                  str(seed), "--overwrite", "--out", str(drive)])
    return drive


def precision_rows(name, scores):
    def recall(row):
        return " / ".join(f"{100 * b['found'] / b['truth']:.0f}" if b["truth"] else "-" for b in row["recall_by_range"])

    return [[name, row["class"], row["box"], f"{row['iou']:g}",
             " / ".join(f"{100 * row[d]['ap']:.1f}" for d in ("easy", "moderate", "hard")),
             " / ".join(str(row[d]["truth"]) for d in ("easy", "moderate", "hard")), recall(row)] for row in scores]


def judge(options, arguments, classes):
    return json.loads(run_mlo(options.program, ["eval", "detection", *arguments, "--json", "--class", *classes]))


def trajectory_cell(options, run, estimate_out, truth):
    run_mlo(options.program, ["run", *run, "--out", str(estimate_out)])
    errors = json.loads(run_mlo(options.program, ["eval", "trajectory", "--json", "--truth", str(truth), "--estimate",
                                                  str(estimate_out / "trajectory.txt")]))["estimates"][0]
    return f"{errors['ate_m']:.4f} / {errors['rte_m_per_frame']:.4f} / {errors['rre_deg_per_frame']:.4f}"


def trajectory_rows(options, name, run, truth):
    cells = [trajectory_cell(options, [*run, "--detector", detector], options.out / "runs" / f"{name}_{detector}", truth)
             for detector in ("none", *options.detector)]
    return [[name, *cells]]


def detect(options, detector, name, folder, more=()):
    """The boxes of a drive, with the poses of its run."""
    file = options.out / f"{name}_{detector}{'_all' if more else ''}.csv"
    poses = options.out / "runs" / f"{name}_{detector}" / "trajectory.txt"
    run_mlo(options.program, ["detect", *folder, "--out", str(file), "--poses", str(poses), "--set",
                              f"detection.detector={detector}", *more])
    return file


def simulated(options):
    drives = [(f"{scene}_{seed}", simulate(options, scene, seed)) for scene in SCENES for seed in SEEDS]
    trajectories = []
    for name, drive in drives:
        trajectories += trajectory_rows(options, name, [str(drive)], drive / "truth" / "poses_stamp.txt")
    precision = []
    for detector in options.detector:
        arguments = []
        for name, drive in drives:
            boxes = detect(options, detector, name, [str(drive)], ALL_BOXES[detector])
            arguments += ["--truth", str(drive / "truth" / "objects.csv"), "--truth-poses",
                          str(drive / "truth" / "poses_stamp.txt"), "--estimate", str(boxes)]
        precision += precision_rows(f"{detector}, simulated", judge(options, arguments, CLASSES))
    return precision, trajectories


def tracking_rows(options, training, name, boxes):
    out = options.out / f"tracks_{name}"
    run_mlo(options.program, ["track", "--detections", *boxes, "--poses", str(training / "poses_imu"), "--calib",
                              str(training / "calib"), "--sequences", "0000", "--out", str(out)])
    found = json.loads(run_mlo(options.program, [
        "eval", "tracking", "--json", "--truth", str(training / "label_02" / "0000.txt"), "--estimate",
        str(out / "tracks" / "0000.txt"), "--class", *LABELLED, "--match", "image", "box", "--threshold", "0.5"]))
    return [[name, one["class"], one["match"], f"{100 * one['all']['hota']:.1f}", f"{100 * one['all']['mota']:.1f}",
             str(one["all"]["false_positives"]), str(one["all"]["false_negatives"]), str(one["all"]["id_switches"])]
            for one in found]


def object_rows(options, training, name, more):
    out = options.out / "runs" / f"objects_{name}"
    run_mlo(options.program, ["run", str(training), "--sequence", "0000", "--out", str(out), *more])
    found = json.loads(run_mlo(options.program, [
        "eval", "objects", "--json", "--estimate", str(out / "objects.csv"), "--truth",
        str(training / "label_02" / "0000.txt"), "--calib", str(training / "calib" / "0000.txt"), "--truth-poses",
        str(options.data / "truth_lidar" / "0005_vel.txt")]))

    def cell(value):
        return "-" if value is None else f"{value:.3f}"

    return [[name, str(row["id"]), row["class"], "lost" if row["track"] is None else str(row["track"]),
             f"{row['tracked_frames']} of {row['truth_frames']}", str(row["switches"]), cell(row["ate_m"]),
             cell(row["rte_m_per_m"]), cell(row["rre_deg_per_m"])]
            for row in found["objects"] if row["truth_frames"] >= 20]


def real(options):
    training = options.data / "kitti_tracking" / "training"
    published = [str(training / "detections" / f"pointrcnn_{kind}") for kind in LABELLED]
    labels = ["--truth", str(training / "label_02" / "0000.txt"), "--calib", str(training / "calib" / "0000.txt")]
    trajectories = []
    for sequence in SEQUENCES:
        trajectories += trajectory_rows(options, sequence.name, [str(options.data / sequence.folder)],
                                        options.data / sequence.truth)
    folder = [str(training), "--sequence", "0000"]
    precision, tracking, objects = [], [], []
    for detector in options.detector:
        every = detect(options, detector, "0005", folder, ALL_BOXES[detector])
        precision += precision_rows(f"{detector}, 0005", judge(options, [*labels, "--estimate", str(every)], LABELLED))
        tracking += tracking_rows(options, training, detector, [str(detect(options, detector, "0005", folder))])
        objects += object_rows(options, training, detector, ["--detector", detector])
    for kind, path in zip(LABELLED, published):
        precision += precision_rows("PointRCNN, 0005", judge(options, [*labels, "--estimate", path], [kind]))
    tracking += tracking_rows(options, training, "PointRCNN", published)
    objects += object_rows(options, training, "PointRCNN", ["--detections", *published])
    return precision, tracking, objects, trajectories


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, metavar="ROOT", help="without it only simulated drives are measured")
    parser.add_argument("--program", default="build/bin/mlo")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--detector", nargs="+", default=["cluster", "3dssd"], choices=list(ALL_BOXES))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    precision, trajectories = simulated(options)
    tracking, objects = [], []
    if options.data:
        more_precision, tracking, objects, more_trajectories = real(options)
        precision, trajectories = precision + more_precision, trajectories + more_trajectories
    tables = [markdown(["boxes", "class", "overlap", "IoU", "AP easy / moderate / hard", "true boxes",
                        "recall 0-10 / -20 / -30 / -40 / -50 / -70 m"], precision),
              markdown(["drive", "no detector", *options.detector], trajectories)]
    if options.data:
        tables += [markdown(["boxes", "class", "match", "HOTA", "MOTA", "FP", "FN", "IDSW"], tracking),
                   markdown(["boxes", "object", "class", "track", "frames", "switches", "ATE [m]", "RTE [m/m]",
                             "RRE [deg/m]"], objects)]
    text = "\n\n".join(tables) + "\n"
    (options.out / "detectors.md").write_text(text, encoding="utf-8")
    print(text, end="")


if __name__ == "__main__":
    main()
