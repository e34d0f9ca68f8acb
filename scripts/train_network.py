#!/usr/bin/python3
"""Trains the network that comes with mlo: config/networks/3dssd_small.safetensors, on simulated drives alone.

Simulates compensated drives through five scenes (seeds 101 to 106 to learn from, 107 to judge by; those that are in OUT
already are not simulated again) and runs `mlo train`, which needs a build with -DMLO_WITH_TORCH=ON. Run it again to go on
where it was stopped. OUT/network/weights.safetensors is the result.
"""

import argparse
import subprocess
from pathlib import Path

SCENES = ["city", "highway", "jam", "parking", "suburb"]
SEEDS = range(101, 107)
JUDGED_SEED = 107
SETTINGS = ["seed=1", "epochs=120", "batch=4", "learning_rate=0.003", "every=2", "augmentation.max_rotation_deg=45"]


def simulate(options, scene, seed, scans):
    drive = options.out / "drives" / f"{scene}_{seed}"
    if not (drive / "truth" / "static_map.ply").is_file():  # written last
        subprocess.run([options.program, "--quiet", "simulate", "--scene", scene, "--seed", str(seed), "--length", "120",
                        "--scans", str(scans), "--compensated", "--map-voxel", "2", "--overwrite", "--out", drive],
                       check=True)
    return drive


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="build/bin/mlo")
    parser.add_argument("--out", type=Path, required=True)
    options = parser.parse_args()
    learnt = [simulate(options, scene, seed, 50) for scene in SCENES for seed in SEEDS]
    judged = [simulate(options, scene, JUDGED_SEED, 16) for scene in SCENES]
    subprocess.run([options.program, "train", *learnt, "--validate", *judged, "--validation-scans", "40",
                    "--validate-every", "1000", "--resume", "--out", options.out / "network",
                    *[word for setting in SETTINGS for word in ("--set", setting)]], check=True)


if __name__ == "__main__":
    main()
