#!/usr/bin/env python3
"""Mitsuba 3's light at the receivers of a Halflight scene.

Reads folders written by `halflight export --to mitsuba` and writes what Mitsuba finds at each receiver into `mitsuba.json` there,
for `halflight crosscheck` to hold the truth against: mean outgoing radiance and the mean's variance. Light by light, it is the sum of

- direct light, `albedo/pi * integral of L V max(0, n.w)`, by Mitsuba's emitters and ray tracing;
- indirect light: `albedo` times what Mitsuba's path tracer finds along a ray of the cosine lobe, less what it sees there directly.

Needs `mitsuba` and `numpy` (PyPI) and LLVM (Debian's `libllvm19`; older ones abort the process). Exit status 2: cannot be run.
"""

import argparse
import json
import pathlib
import sys

import drjit as dr
import mitsuba as mi
import numpy as np

CHUNK = 1 << 21  # samples at once
PER_PASS = 1024  # samples of a receiver at once: their f32 sum is exact enough
# Rays start so far off the surface, relative to 1 m or the distance from the origin. About as far as Halflight's: where a light
# shines above the shading normal's horizon but below the triangle's, more of it slips over the triangle's edge the farther off.
OFFSET = 2e-6
COLUMNS = {"position": "x y z", "geometric": "gx gy gz", "normal": "nx ny nz", "albedo": "albedo_r albedo_g albedo_b"}
# Shadow rays end so much short of the light, a share of their way: what lies that close before it casts no shadow.
SHORT = 1e-4
BRIGHTER = 1.01
TURN = 5.0  # degrees
ROULETTE = 8  # reflections after which long paths may end by chance


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", type=pathlib.Path, metavar="DIR")
    parser.add_argument("--samples", type=int, default=16384, help=f"at every receiver, a multiple of {PER_PASS}")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--wrong", choices=["scale", "albedo", "mirror", "turn"],
                        help="make Mitsuba's picture wrong, which must be found: light or surfaces 1%% brighter, or the environment "
                             "mirrored or turned")
    options = parser.parse_args()
    if options.samples < PER_PASS or options.samples % PER_PASS:
        parser.error(f"--samples {options.samples}: expected a multiple of {PER_PASS}")
    for folder in options.folders:
        render(folder, options)


def render(folder, options):
    """Writes what Mitsuba finds at the receivers of one folder."""
    export = json.loads((folder / "export.json").read_text())
    table = np.genfromtxt(folder / "receivers.csv", delimiter=",", names=True)
    receivers = {name: np.stack([table[column] for column in columns.split()], axis=1) for name, columns in COLUMNS.items()}

    mean, variance = np.zeros((len(table), 3)), np.zeros((len(table), 3))
    spoiled = options.wrong in (None, "scale")
    for index, light in enumerate(export["lights"]):
        scene = mi.load_file(str(folder / light))
        spoiled |= spoil(scene, options.wrong)
        for part in parts(export["quantity"]):
            seed = hash((options.seed, index, len(part))) % 2**31
            found = estimate(lambda chunk, sampler: part[0](scene, chunk, sampler, *part[1:]), receivers, options.samples, seed)
            mean, variance = mean + found[0], variance + found[1]
    if not spoiled:
        sys.exit(f"render.py: {folder}: nothing there to make wrong by --wrong {options.wrong}")
    if options.wrong == "scale":
        mean, variance = BRIGHTER * mean, BRIGHTER**2 * variance
    answer = {"program": f"Mitsuba {mi.__version__}, {mi.variant()}", "wrong": options.wrong, "samples": options.samples,
              "mean": mean.tolist(), "variance": variance.tolist()}
    (folder / "mitsuba.json").write_text(json.dumps(answer))


def parts(quantity):
    """What samples the parts of a quantity: a function and its further arguments."""
    if quantity == "direct":
        return [(direct,)]
    if quantity == "total":
        return [(direct,), (indirect, path_tracer(-1))]
    # Emission that is seen at once has depth 1, light reflected once depth 2.
    return [(indirect, path_tracer(int(quantity.removeprefix("indirect-")) + 1))]


def path_tracer(depth):
    return mi.load_dict({"type": "path", "max_depth": depth, "rr_depth": ROULETTE if depth < 0 else depth + 1})


def spoil(scene, wrong):
    """Makes surfaces brighter, or mirrors or turns the environment; whether there was something to change."""
    parameters = mi.traverse(scene)
    if wrong == "albedo":
        names = [name for name in parameters.keys() if name.endswith("reflectance.value")]
        for name in names:
            parameters[name] = mi.Color3f(parameters[name]) * BRIGHTER
    elif wrong in ("mirror", "turn") and "environment.to_world" in parameters:
        names = ["environment.to_world"]
        upright = mi.ScalarTransform4f(np.array(parameters[names[0]].matrix).reshape(4, 4))
        change = mi.ScalarTransform4f().scale([1, -1, 1]) if wrong == "mirror" \
            else mi.ScalarTransform4f().rotate([0, 0, 1], TURN)
        parameters[names[0]] = mi.AffineTransform4f((change @ upright).matrix)
    else:
        return False
    parameters.update()
    return bool(names)


def estimate(sample, receivers, samples, seed):
    """Mean and variance of the mean at every receiver, a column a channel. A sample brings light, and `grain`: what it would
    bring with nothing in its way, if it either arrives whole or not at all."""
    count = len(receivers["position"])
    sums, squares, grains = (np.zeros((count, 3)) for _ in range(3))
    step = max(1, CHUNK // PER_PASS)
    for first in range(0, count, step):
        chunk = {name: values[first:first + step] for name, values in receivers.items()}
        rows = slice(first, min(first + step, count))
        each = {name: dr.repeat(mi.Vector3f(values.T.astype(np.float32)), PER_PASS) for name, values in chunk.items()}
        each["start"] = each["position"] + each["geometric"] * OFFSET * dr.maximum(1, dr.norm(each["position"]))
        sampler = mi.load_dict({"type": "independent"})
        sampler.seed(seed + first * 7919, (rows.stop - rows.start) * PER_PASS)
        for _ in range(samples // PER_PASS):
            light, grain = sample(each, sampler)
            sums[rows] += block_sums(light)
            squares[rows] += block_sums(light * light)
            grains[rows] += block_sums(grain * grain)
    mean = sums / samples
    # Light comes in whole rays: none or all of them blocked does not make it certain. Half a ray (Jeffreys) more or less, as
    # Halflight counts its own.
    grain = grains / samples * (0.5 / samples) / samples
    return mean, (squares / samples - mean**2) / (samples - 1) + grain


def direct(scene, receivers, sampler):
    """What one sampled direction towards a light and one of the cosine lobe bring, weighed by the balance heuristic; and what the
    former would bring with nothing in its way."""
    start = dr.zeros(mi.SurfaceInteraction3f, dr.width(receivers["start"]))
    start.p = mi.Point3f(receivers["start"])
    towards, weight = scene.sample_emitter_direction(start, sampler.next_2d(), test_visibility=False)
    lobe = dr.maximum(0, dr.dot(receivers["normal"], towards.d)) / dr.pi
    unblocked = receivers["albedo"] * mi.Vector3f(weight) * lobe * towards.pdf / (towards.pdf + lobe)
    unblocked = dr.select(towards.pdf > 0, unblocked, 0)
    ray = mi.Ray3f(start.p, towards.d, towards.dist * (1 - SHORT), 0, [])
    light = dr.select(scene.ray_test(ray, lobe > 0), 0, unblocked)

    ray, density = cosine_lobe(receivers, sampler)
    seen = scene.ray_intersect(ray)
    other = scene.pdf_emitter_direction(start, mi.DirectionSample3f(scene, seen, start))
    emitted = mi.Vector3f(seen.emitter(scene).eval(seen)) * density / (density + other)
    return light + receivers["albedo"] * dr.select(density > 0, emitted, 0), unblocked


def indirect(scene, receivers, sampler, path_tracer):
    """What one ray of the cosine lobe brings of light that was reflected."""
    ray, _ = cosine_lobe(receivers, sampler)
    light, _, _ = path_tracer.sample(scene, sampler, ray)
    seen = scene.ray_intersect(ray)
    light -= seen.emitter(scene).eval(seen)
    return receivers["albedo"] * mi.Vector3f(light), mi.Vector3f(0)


def cosine_lobe(receivers, sampler):
    """A ray of the cosine lobe about the shading normal, and its density a steradian."""
    local = mi.warp.square_to_cosine_hemisphere(sampler.next_2d())
    towards = mi.Frame3f(receivers["normal"]).to_world(local)
    return mi.RayDifferential3f(mi.Point3f(receivers["start"]), towards, 0, []), mi.Frame3f.cos_theta(local) / dr.pi


def block_sums(values):
    return np.stack([dr.block_sum(channel, PER_PASS).numpy() for channel in values], axis=1).astype(np.float64)


if __name__ == "__main__":
    try:
        mi.set_variant("llvm_ad_rgb")
    except ImportError as error:
        print(f"render.py: {error}", file=sys.stderr)
        sys.exit(2)
    main()
