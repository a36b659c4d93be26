"""Posed vertices of a glTF file: `gltf.py FILE CLIP TIME...` prints, for each time, the vertices of every mesh, y up.

Written from the specification alone, with pygltflib for the file's structure and numpy in double precision.
"""

import json
import sys

import numpy as np
from pygltflib import GLTF2

TYPES = {5120: np.int8, 5121: np.uint8, 5122: np.int16, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


def numbers(gltf, index):
    accessor = gltf.accessors[index]
    view = gltf.bufferViews[accessor.bufferView]
    kind, width = np.dtype(TYPES[accessor.componentType]).newbyteorder("<"), WIDTHS[accessor.type]
    start = (view.byteOffset or 0) + (accessor.byteOffset or 0)
    stride = view.byteStride or width * kind.itemsize
    blob = gltf.binary_blob()
    rows = [np.frombuffer(blob, kind, width, start + i * stride) for i in range(accessor.count)]
    values = np.array(rows, dtype=np.float64)
    return values / np.iinfo(kind).max if accessor.normalized else values


def rotation(x, y, z, w):
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def slerp(a, b, t):
    cosine = float(np.dot(a, b))
    b, cosine = (-b, -cosine) if cosine < 0 else (b, cosine)
    angle = np.arccos(min(cosine, 1.0))
    if angle < 1e-9:
        return a
    return (np.sin((1 - t) * angle) * a + np.sin(t * angle) * b) / np.sin(angle)


def sampled(gltf, sampler, path, time):
    times, values = numbers(gltf, sampler.input)[:, 0], numbers(gltf, sampler.output)
    cubic = sampler.interpolation == "CUBICSPLINE"
    keys = values.reshape(len(times), 3, -1) if cubic else values
    plain = keys[:, 1] if cubic else keys
    if time <= times[0] or time >= times[-1]:
        return plain[0] if time <= times[0] else plain[-1]
    k = int(np.searchsorted(times, time, side="right")) - 1
    span = times[k + 1] - times[k]
    t = (time - times[k]) / span
    if sampler.interpolation == "STEP":
        return plain[k]
    if cubic:
        h = [2 * t**3 - 3 * t**2 + 1, span * (t**3 - 2 * t**2 + t), -2 * t**3 + 3 * t**2, span * (t**3 - t**2)]
        value = h[0] * keys[k, 1] + h[1] * keys[k, 2] + h[2] * keys[k + 1, 1] + h[3] * keys[k + 1, 0]
        return value / np.linalg.norm(value) if path == "rotation" else value
    return slerp(plain[k], plain[k + 1], t) if path == "rotation" else (1 - t) * plain[k] + t * plain[k + 1]


def worlds(gltf, clip, time):
    parts = []
    for node in gltf.nodes:
        parts.append(
            {
                "translation": np.array(node.translation or [0, 0, 0], float),
                "rotation": np.array(node.rotation or [0, 0, 0, 1], float),
                "scale": np.array(node.scale or [1, 1, 1], float),
            }
        )
    animation = next(a for a in gltf.animations if a.name == clip)
    for channel in animation.channels:
        path = channel.target.path
        parts[channel.target.node][path] = sampled(gltf, animation.samplers[channel.sampler], path, time)
    local = []
    for node, part in zip(gltf.nodes, parts):
        matrix = np.eye(4)
        matrix[:3, :3] = rotation(*(part["rotation"] / np.linalg.norm(part["rotation"]))) * part["scale"]
        matrix[:3, 3] = part["translation"]
        local.append(np.array(node.matrix, float).reshape(4, 4).T if node.matrix else matrix)
    parent = {child: index for index, node in enumerate(gltf.nodes) for child in node.children or []}

    def world(index):
        return world(parent[index]) @ local[index] if index in parent else local[index]

    return [world(index) for index in range(len(gltf.nodes))]


def posed(gltf, world):
    meshes = []
    for index, node in enumerate(gltf.nodes):
        if node.mesh is None:
            continue
        for primitive in gltf.meshes[node.mesh].primitives:
            points = numbers(gltf, primitive.attributes.POSITION)
            points = np.hstack([points, np.ones((len(points), 1))])
            if node.skin is None:
                meshes.append((points @ world[index].T)[:, :3].tolist())
                continue
            skin = gltf.skins[node.skin]
            inverse = numbers(gltf, skin.inverseBindMatrices).reshape(-1, 4, 4).transpose(0, 2, 1)
            joints = np.array([world[joint] @ inverse[i] for i, joint in enumerate(skin.joints)])
            which = numbers(gltf, primitive.attributes.JOINTS_0).astype(int)
            weights = numbers(gltf, primitive.attributes.WEIGHTS_0)
            weights /= weights.sum(axis=1, keepdims=True)
            blended = np.einsum("vk,vkij->vij", weights, joints[which])
            meshes.append(np.einsum("vij,vj->vi", blended, points)[:, :3].tolist())
    return meshes


def main():
    gltf = GLTF2().load(sys.argv[1])
    print(json.dumps([posed(gltf, worlds(gltf, sys.argv[2], float(time))) for time in sys.argv[3:]]))


main()
