#!/usr/bin/env python3
"""Holds Halflight's truth against Mitsuba 3 at the same receivers.

Reads folders written by `halflight export --to mitsuba`. At every receiver, Mitsuba's light sampling and ray tracing estimate
the outgoing radiance `albedo/pi * integral of L V max(0, n.w)`, light by light; its mean is tested against the truth's, both
variances counted. A scene agrees if neither test at half the significance each (Bonferroni, over receivers and channels)
finds a difference: the largest |z| of single receivers, and |z| of the sum over receivers, which sees what all share.

Needs `mitsuba` and `numpy` (PyPI) and LLVM (Debian's `libllvm19`; older ones abort the process).
Exit status: 0 all agree, 1 some do not, 2 cannot be run.
"""

import argparse
import json
import pathlib
import statistics
import sys

import drjit as dr
import mitsuba as mi
import numpy as np

CHUNK = 1 << 21  # samples at once
PER_PASS = 1024  # samples of a receiver at once: their f32 sum is exact enough
# Rays start so far off the surface, relative to 1 m or the distance from the origin. About as far as Halflight's: where a light
# shines above the shading normal's horizon but below the triangle's, more of it slips over the triangle's edge the farther off.
OFFSET = 2e-6
SIGNIFICANCE = 0.001  # of a scene
TURN = 5.0  # degrees


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", type=pathlib.Path, metavar="DIR")
    parser.add_argument("--samples", type=int, default=16384, help=f"at every receiver, a multiple of {PER_PASS}")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--wrong", choices=["scale", "mirror", "turn"],
                        help="make Mitsuba's light wrong, which must be found: 1%% brighter, or its map mirrored or turned")
    parser.add_argument("--save", type=pathlib.Path, help="write what Mitsuba found (.npz; one folder)")
    options = parser.parse_args()
    if options.samples < PER_PASS or options.samples % PER_PASS:
        parser.error(f"--samples {options.samples}: expected a multiple of {PER_PASS}")
    agree = [compare(folder, options) for folder in options.folders]
    return 0 if all(agree) else 1


def compare(folder, options):
    """Tests one scene and prints a line."""
    export = json.loads((folder / "export.json").read_text())
    table = np.genfromtxt(folder / "receivers.csv", delimiter=",", names=True)
    receivers = {name: columns(table, names) for name, names in {
        "position": "x y z", "geometric": "gx gy gz", "normal": "nx ny nz", "albedo": "albedo_r albedo_g albedo_b"}.items()}
    truth, truth_error = columns(table, "r g b"), columns(table, "se_r se_g se_b")

    mean, variance = np.zeros_like(truth), np.zeros_like(truth)
    for index, light in enumerate(export["lights"]):
        scene = mi.load_file(str(folder / light))
        spoil(scene, options.wrong)
        light_mean, light_variance = estimate(scene, receivers, options.samples, options.seed + 1000 * index)
        mean, variance = mean + light_mean, variance + light_variance
    if options.wrong == "scale":
        mean, variance = 1.01 * mean, 1.01**2 * variance
    if options.save:
        np.savez(options.save, mean=mean, variance=variance, truth=truth, truth_error=truth_error, **receivers)

    verdict = judge(truth, truth_error**2, export["degrees_of_freedom"], mean, variance, options.samples - 1)
    print(f"{export['scene']}: {len(table)} receivers, {options.samples} samples: {verdict['text']}", flush=True)
    return verdict["agree"]


def columns(table, names):
    return np.stack([table[name] for name in names.split()], axis=1)


def spoil(scene, wrong):
    """Mirrors or turns the environment map, where the scene has one."""
    if wrong not in ("mirror", "turn"):
        return
    parameters = mi.traverse(scene)
    if "environment.to_world" not in parameters:
        return
    upright = mi.ScalarTransform4f(np.array(parameters["environment.to_world"].matrix).reshape(4, 4))
    change = mi.ScalarTransform4f().scale([1, -1, 1]) if wrong == "mirror" \
        else mi.ScalarTransform4f().rotate([0, 0, 1], TURN)
    parameters["environment.to_world"] = mi.AffineTransform4f((change @ upright).matrix)
    parameters.update()


def estimate(scene, receivers, samples, seed):
    """Mean and variance of the mean at every receiver, a column a channel."""
    count = len(receivers["position"])
    sums, squares, open_squares = (np.zeros((count, 3)) for _ in range(3))
    step = max(1, CHUNK // PER_PASS)
    for first in range(0, count, step):
        chunk = {name: values[first:first + step] for name, values in receivers.items()}
        rows = slice(first, min(first + step, count))
        sampler = mi.load_dict({"type": "independent"})
        sampler.seed(seed + first * 7919, (rows.stop - rows.start) * PER_PASS)
        for _ in range(samples // PER_PASS):
            light, unblocked = sample(scene, chunk, sampler)
            sums[rows] += block_sums(light)
            squares[rows] += block_sums(light * light)
            open_squares[rows] += block_sums(unblocked * unblocked)
    mean = sums / samples
    # Light comes in whole rays: none or all of them blocked does not make it certain. Half a ray (Jeffreys) more or less, as
    # Halflight counts its own.
    grain = open_squares / samples * (0.5 / samples) / samples
    return mean, (squares / samples - mean**2) / (samples - 1) + grain


def sample(scene, receivers, sampler):
    """What one sampled direction brings, and would with nothing in its way; PER_PASS at every receiver in turn."""
    each = {name: dr.repeat(mi.Vector3f(values.T.astype(np.float32)), PER_PASS) for name, values in receivers.items()}
    position, geometric = each["position"], each["geometric"]
    start = dr.zeros(mi.SurfaceInteraction3f, dr.width(position))
    start.p = mi.Point3f(position + geometric * OFFSET * dr.maximum(1, dr.norm(position)))
    direction, weight = scene.sample_emitter_direction(start, sampler.next_2d(), test_visibility=False)
    cosine = dr.maximum(0, dr.dot(each["normal"], direction.d))
    unblocked = each["albedo"] * mi.Vector3f(weight) * cosine / dr.pi
    ray = mi.Ray3f(start.p, direction.d, direction.dist * (1 - 1e-3), 0, [])
    light = dr.select(scene.ray_test(ray, cosine > 0), 0, unblocked)
    return light, unblocked


def block_sums(values):
    return np.stack([dr.block_sum(channel, PER_PASS).numpy() for channel in values], axis=1).astype(np.float64)


def judge(truth, truth_variance, truth_degrees, mean, variance, degrees):
    """Both tests, and a text of them."""
    difference, both = truth - mean, truth_variance + variance
    used = both > 0
    if not used.any() or np.any(difference[~used] != 0):
        return {"agree": False, "text": "DIFFER where both are certain, or nothing to test"}
    freedom = both[used]**2 / (truth_variance[used]**2 / truth_degrees + variance[used]**2 / degrees)
    z = normal_of_student(difference[used] / np.sqrt(both[used]), freedom)
    normal = statistics.NormalDist()
    limit = -normal.inv_cdf(SIGNIFICANCE / 2 / 2 / z.size)
    sums, deviations = difference.sum(axis=0), np.sqrt(both.sum(axis=0))
    sum_z = sums / deviations
    sum_limit = -normal.inv_cdf(SIGNIFICANCE / 2 / 2 / 3)
    largest, largest_sum = np.abs(z).max(), np.abs(sum_z).max()
    agree = bool(largest < limit and largest_sum < sum_limit)
    p = min(1.0, 2 * min(2 * normal.cdf(-largest) * z.size, 2 * normal.cdf(-largest_sum) * 3))
    ratio, ratio_error = truth.sum() / mean.sum(), np.sqrt(both.sum()) / mean.sum()
    return {"agree": agree, "text":
            f"{'agree' if agree else 'DIFFER'}; largest |z| {largest:.2f} (limit {limit:.2f}), of the sum {largest_sum:.2f} "
            f"(limit {sum_limit:.2f}), p {p:.2g}; mean z {z.mean():+.4f}, rms z {np.sqrt((z**2).mean()):.3f}, "
            f"Halflight/Mitsuba {ratio:.6f} +- {ratio_error:.6f}"}


def normal_of_student(t, degrees):
    """The normal deviate that is as rare as Student's t (Wallace 1959; within 1e-3 from 60 degrees of freedom on)."""
    return np.sign(t) * (8 * degrees + 1) / (8 * degrees + 3) * np.sqrt(degrees * np.log1p(t**2 / degrees))


if __name__ == "__main__":
    try:
        mi.set_variant("llvm_ad_rgb")
    except ImportError as error:
        print(f"compare.py: {error}", file=sys.stderr)
        sys.exit(2)
    sys.exit(main())
