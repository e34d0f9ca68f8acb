#!/usr/bin/env python3
"""Kills runs at random moments, opens what they leave, resumes them, and compares with a run that was never stopped.

  scripts/kill_test.py --out out/kills                       # simulates a drive of its own
  scripts/kill_test.py --scans FOLDER --kills 20 --out out/kills
"""
import argparse
import hashlib
import json
import pathlib
import random
import shutil
import subprocess
import sys
import time

# These tell times taken, which are never the same.
NOT_COMPARED = ["per_scan.csv", "run.json"]


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="build/bin/mlo")
    parser.add_argument("--scans", help="folder of scans (default: a simulated drive of 30 scans)")
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--save-every", type=int, default=5, help="scans between states to resume from")
    parser.add_argument("--seed", type=int, default=1, help="of the moments")
    parser.add_argument("--out", required=True, type=pathlib.Path)
    return parser.parse_args()


def simulate(arguments):
    drive = arguments.out / "drive"
    subprocess.run([arguments.program, "-q", "simulate", "--scene", "city", "--scans", "30", "--length", "60", "--seed", "7",
                    "--set", "sensor.columns=360", "--overwrite", "--out", drive], check=True, stdout=subprocess.DEVNULL)
    arguments.scans = drive


def command(arguments, out, *more):
    words = [arguments.program, "-q", "run", arguments.scans, "--out", out, "--save-every", arguments.save_every]
    return [str(word) for word in words + list(more)]


def results(folder):
    files = sorted(file for file in folder.rglob("*") if file.is_file() and file.name not in NOT_COMPARED)
    return {str(file.relative_to(folder)): hashlib.sha256(file.read_bytes()).hexdigest() for file in files}


def killed_after(arguments, out, seconds):
    """Starts a run, kills it; false if it had ended before."""
    process = subprocess.Popen(command(arguments, out), stdout=subprocess.DEVNULL)
    try:
        process.wait(timeout=seconds)
        return False
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
        return True


def check_scene(arguments, out):
    """Problems of the scene that a killed run left; a run that had not begun may have left none."""
    if not (out / "scene.mlo").exists() or (out / "scene.mlo").stat().st_size == 0:
        return [], 0
    shown = subprocess.run([arguments.program, "scene", out / "scene.mlo", "--json"], capture_output=True, text=True)
    if shown.returncode != 0:
        return ["the scene does not open: " + shown.stderr.strip()], 0
    scans = json.loads(shown.stdout)["scans"]
    rows = (out / "trajectory.txt").read_text().count("\n") if (out / "trajectory.txt").exists() else 0
    # The last scan may have been on its way into the file.
    return ([] if scans + 1 >= rows else [f"the scene has {scans} scans, the trajectory {rows}"]), scans


def check_once(arguments, index, duration, expected):
    """Kills a run and looks at what it left and at how it goes on; true if all was as it should be."""
    out = arguments.out / f"killed_{index:03}"
    shutil.rmtree(out, ignore_errors=True)
    seconds = random.uniform(0.0, duration)
    while not killed_after(arguments, out, seconds):
        seconds = random.uniform(0.0, duration)
    problems, scans = check_scene(arguments, out)
    subprocess.run(command(arguments, out, "--resume"), check=True, stdout=subprocess.DEVNULL)
    found = results(out)
    problems += [f"{name} differs" for name in expected if found.get(name) != expected[name]]
    problems += [f"{name} is new" for name in found if name not in expected]
    print(f"{index:3}: killed after {seconds:6.2f} s, {scans} scans in the scene:",
          "; ".join(problems) or "same bytes after --resume", flush=True)
    shutil.rmtree(out)
    return not problems


def main():
    arguments = parse_arguments()
    arguments.out.mkdir(parents=True, exist_ok=True)
    if not arguments.scans:
        simulate(arguments)
    reference = arguments.out / "reference"
    shutil.rmtree(reference, ignore_errors=True)
    start = time.monotonic()
    subprocess.run(command(arguments, reference), check=True, stdout=subprocess.DEVNULL)
    duration = time.monotonic() - start
    expected = results(reference)
    random.seed(arguments.seed)
    good = [check_once(arguments, i, duration, expected) for i in range(arguments.kills)]
    print(f"{sum(good)} of {len(good)} killed runs opened and ended with the same bytes")
    sys.exit(0 if all(good) else 1)


if __name__ == "__main__":
    main()
