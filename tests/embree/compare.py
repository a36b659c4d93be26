#!/usr/bin/env python3
"""Holds Halflight's hits against Embree's (robust mode) on the same triangles and rays.

Reads folders with little-endian arrays: vertices.f32 and triangles.u32 (three a row), rays.f32 (origin and direction), and what
Halflight found: t.f32 (infinite: nothing), primitive.u32, blocked.u8.

Both do exact arithmetic nowhere, so they may differ where a ray passes an edge of the hit triangle within rounding: nearer than
EDGE times the largest coordinate difference between the ray's origin and the triangle's corners, which is what coordinates
relative to the origin are rounded by in f32, a few times. Then one of them may go on to what lies behind. Two triangles may
also be as near as their distances are rounded. Of rays that were aimed at nothing, only very few get so near. Everything else is a difference: another triangle, a miss, another answer to
"is anything there", or a distance off by more than rounding over the cosine of incidence.

Needs `embreex` and `numpy` (PyPI). Exit status: 0 all agree, 1 some do not, 2 cannot be run.
"""

import argparse
import pathlib
import sys

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene

EDGE = 16 * 2.0**-24
DISTANCE = 16 * 2.0**-24
BY_CHANCE = 2e-5  # of unaimed rays may be within rounding of an edge
NOTHING = 0xFFFFFFFF


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", type=pathlib.Path, metavar="DIR")
    parser.add_argument("--unaimed", type=int, default=0, help="so many of the rays, the first, were aimed at nothing")
    parser.add_argument("--wrong", action="store_true", help="lift one triangle of Embree's mesh, which must be found")
    options = parser.parse_args()
    agree = [compare(folder, options) for folder in options.folders]
    return 0 if all(agree) else 1


def compare(folder, options):
    """Compares one mesh and prints a line."""
    vertices = np.fromfile(folder / "vertices.f32", "<f4").reshape(-1, 3)
    triangles = np.fromfile(folder / "triangles.u32", "<u4").reshape(-1, 3)
    rays = np.fromfile(folder / "rays.f32", "<f4").reshape(-1, 6)
    t = np.fromfile(folder / "t.f32", "<f4").astype(np.float64)
    primitive = np.fromfile(folder / "primitive.u32", "<u4")
    blocked = np.fromfile(folder / "blocked.u8", np.uint8) != 0

    theirs = embree(*(lifted(vertices, triangles, primitive) if options.wrong else (vertices, triangles)), rays)
    geometry = Geometry(vertices, triangles, rays)
    answered = np.concatenate([primitive != NOTHING, theirs["primitive"] != NOTHING]).mean()

    same = primitive == theirs["primitive"]
    hit = np.flatnonzero(same & (primitive != NOTHING))
    off = np.abs(t[hit] - theirs["t"][hit]) > 2 * geometry.distance_error(hit, primitive[hit])
    other = np.flatnonzero(~same)
    excused = geometry.excused(other, primitive[other], t[other], theirs["primitive"][other], theirs["t"][other])
    # Any hit and nearest hit are different walks, but the same question.
    undecided = np.zeros(len(rays), bool)
    undecided[other[excused]] = True
    denied = (blocked != theirs["blocked"]) & ~undecided

    by_chance = int((other[excused] < options.unaimed).sum())

    wrong_count = int(off.sum() + (~excused).sum() + denied.sum()) + max(0, by_chance - int(BY_CHANCE * options.unaimed))
    print(f"{folder.name}: {len(triangles)} triangles, {len(rays)} rays, {answered:.1%} hit: "
          f"{'agree' if wrong_count == 0 else 'DIFFER'}; {int(excused.sum())} within rounding of an edge or a tie, "
          f"{by_chance} of them of {options.unaimed} unaimed rays; "
          f"{int((~excused).sum())} other triangles, {int(off.sum())} other distances, {int(denied.sum())} other occlusions", flush=True)
    for ray in np.concatenate([other[~excused], hit[off], np.flatnonzero(denied)])[:5]:
        print(f"  ray {rays[ray].tolist()}: ours {primitive[ray]} at {t[ray]}, "
              f"Embree's {theirs['primitive'][ray]} at {theirs['t'][ray]}")
    return wrong_count == 0


def lifted(vertices, triangles, primitive):
    """The mesh with its most hit triangle off its place by its own size."""
    hits = np.bincount(primitive[primitive != NOTHING], minlength=len(triangles))
    chosen = int(hits.argmax())
    corners = vertices[triangles[chosen]]
    size = np.linalg.norm(corners - corners[[1, 2, 0]], axis=1).max()
    normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    moved = corners + size * normal / np.linalg.norm(normal)
    triangles = triangles.copy()
    triangles[chosen] = len(vertices) + np.arange(3)
    return np.concatenate([vertices, moved.astype(np.float32)]), triangles


def embree(vertices, triangles, rays):
    scene = EmbreeScene(robust=True)
    TriangleMesh(scene, np.ascontiguousarray(vertices), np.ascontiguousarray(triangles))
    origins, directions = np.ascontiguousarray(rays[:, :3]), np.ascontiguousarray(rays[:, 3:])
    found = scene.run(origins, directions, output=True)
    blocked = scene.run(origins, directions, query="OCCLUDED") >= 0
    missed = found["primID"] < 0
    t = np.where(missed, np.inf, found["tfar"].astype(np.float64))
    return {"primitive": found["primID"].astype(np.uint32), "t": t, "blocked": blocked}


class Geometry:
    """Triangles as rays see them, in f64."""

    def __init__(self, vertices, triangles, rays):
        self.corners = vertices.astype(np.float64)[triangles]
        self.origins, self.directions = rays[:, :3].astype(np.float64), rays[:, 3:].astype(np.float64)

    def relative(self, ray, primitive):
        """Corners relative to the ray's origin, and the largest of their coordinates."""
        corners = self.corners[primitive] - self.origins[ray][:, None]
        return corners, np.abs(corners).max(axis=(1, 2))

    def distance_error(self, ray, primitive):
        """What rounding may do to the distance of a hit: coordinates' rounding over the cosine of incidence."""
        corners, reach = self.relative(ray, primitive)
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        cosine = np.abs((normal * self.directions[ray]).sum(axis=1)) / np.linalg.norm(normal, axis=1)
        with np.errstate(divide="ignore"):
            return DISTANCE * reach / cosine

    def near_edge(self, ray, primitive):
        """Whether the ray's line passes an edge of the triangle within rounding."""
        corners, reach = self.relative(ray, primitive)
        direction = self.directions[ray] / np.linalg.norm(self.directions[ray], axis=1, keepdims=True)
        # Distances in the plane across the ray, which shows the triangle as the ray sees it.
        flat = corners - (corners * direction[:, None]).sum(axis=2, keepdims=True) * direction[:, None]
        nearest = np.full(len(ray), np.inf)
        for a, b in ((0, 1), (1, 2), (2, 0)):
            along = flat[:, b] - flat[:, a]
            squared = (along**2).sum(axis=1)
            part = np.clip(-(flat[:, a] * along).sum(axis=1) / np.where(squared > 0, squared, 1), 0, 1)
            nearest = np.minimum(nearest, np.linalg.norm(flat[:, a] + part[:, None] * along, axis=1))
        return nearest <= EDGE * reach

    def excused(self, ray, ours, our_t, theirs, their_t):
        """Whether rounding may be why the two name different triangles: the nearer is met at its edge, or both tie."""
        nearer = np.where(our_t <= their_t, ours, theirs)
        both = (ours != NOTHING) & (theirs != NOTHING)
        gap = np.full(len(ray), np.inf)
        gap[both] = np.abs(our_t[both] - their_t[both])
        allowed = np.zeros(len(ray))
        for primitive in (ours, theirs):
            allowed[both] += self.distance_error(ray[both], primitive[both])
        return self.near_edge(ray, nearer) | (gap <= allowed)


if __name__ == "__main__":
    sys.exit(main())
