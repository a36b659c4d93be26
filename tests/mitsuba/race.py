#!/usr/bin/env python3
"""CPU time to a relative error of 1% in direct light: Halflight's truth against Mitsuba 3 (`llvm_ad_rgb`) at the same receivers.

The error is the root mean square over receivers and channels against a common reference of many samples, over that one's mean; it
falls as measured for Halflight (low-discrepancy points), with the root of the samples for Mitsuba (independent ones). CPU time is
user and system time of all threads, so that it hardly depends on what else the machine does. Not counted: loading and export
(Halflight: what a run with one receiver takes), and Mitsuba's compilation of kernels, which is told apart. Both in turn.

    cargo build --release -p halflight
    python3 tests/mitsuba/race.py target/release/halflight bunny-studio teapot-sunset interior
"""

import argparse
import json
import os
import pathlib
import resource
import statistics
import subprocess
import tempfile

import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")
import render  # noqa: E402: its annotations need the variant

GOAL = 0.01
COUNTS = [128, 256, 512, 1024, 2048]  # Halflight's samples a receiver
THEIRS = 256  # Mitsuba's


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("halflight", type=pathlib.Path)
    parser.add_argument("scenes", nargs="+")
    parser.add_argument("--receivers", type=int, default=4000)
    parser.add_argument("--repeats", type=int, default=5)
    options = parser.parse_args()
    for scene in options.scenes:
        with tempfile.TemporaryDirectory() as folder:
            race(options, scene, pathlib.Path(folder))


def race(options, scene, folder):
    """Prints a line."""
    def ours(receivers, samples, seed):
        with tempfile.TemporaryDirectory() as cache:
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            subprocess.run([options.halflight.resolve(), "export", "--scene", scene, "--to", "mitsuba", "--out", folder, "--cache", cache,
                            "--receivers", str(receivers), "--samples", str(samples), "--seed", str(seed)],
                           check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
        table = np.genfromtxt(folder / "receivers.csv", delimiter=",", names=True)
        light = None if receivers == 1 else np.stack([table[channel] for channel in "rgb"], axis=1)
        return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, light

    _, reference = ours(options.receivers, 16384, 99)
    def error(light):
        return np.sqrt(np.mean((light - reference)**2)) / reference.mean()

    table = np.genfromtxt(folder / "receivers.csv", delimiter=",", names=True)
    receivers = {name: np.stack([table[column] for column in columns.split()], axis=1) for name, columns in render.COLUMNS.items()}
    lights = json.loads((folder / "export.json").read_text())["lights"]
    scenes = [mi.load_file(str(folder / light)) for light in lights]

    def theirs(seed):
        before = sum(os.times()[:2])
        found = [render.estimate(lambda chunk, sampler: render.direct(scene, chunk, sampler), receivers, THEIRS, seed + 100 * i)[0]
                 for i, scene in enumerate(scenes)]
        return sum(os.times()[:2]) - before, sum(found)

    render.PER_PASS = THEIRS
    first, _ = theirs(0)
    halflight, mitsuba = [], []
    for repeat in range(1, options.repeats + 1):
        times, errors = [], []
        for samples in COUNTS:
            time, light = ours(options.receivers, samples, repeat)
            idle, _ = ours(1, samples, repeat)
            times.append(max(time - idle, 1e-3))
            errors.append(error(light))
        halflight.append(at_goal(times, errors))
        time, light = theirs(repeat)
        mitsuba.append(time * (error(light) / GOAL)**2)
    compiling = first - time
    ratios = [m / h for h, m in zip(halflight, mitsuba)]
    spread = lambda values: f"{statistics.median(values):.3g} ({min(values):.3g} to {max(values):.3g})"
    print(f"{scene}: {options.receivers} receivers to {GOAL:.0%}: Halflight {spread(halflight)} s, Mitsuba {spread(mitsuba)} s, "
          f"Mitsuba/Halflight {spread(ratios)}; Mitsuba's kernels {compiling:.2g} s once", flush=True)


def at_goal(times, errors):
    """Time at which the error is the goal: a straight line through logarithms about it, or at the nearer end."""
    x, y = -np.log(errors), np.log(times)
    place = np.clip(np.searchsorted(x, -np.log(GOAL)), 1, len(x) - 1)
    slope = (y[place] - y[place - 1]) / (x[place] - x[place - 1])
    return float(np.exp(y[place] + slope * (-np.log(GOAL) - x[place])))


if __name__ == "__main__":
    main()
