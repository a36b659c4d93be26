"""Joint positions of a Biovision hierarchy: `bvh.py FILE FRAME...` prints, for each frame, those of all joints, y up.

Written from the format's description alone, with numpy in double precision.
"""

import json
import sys

import numpy as np


def read(path):
    words = open(path).read().split()
    joints, stack, at = [], [], 1
    while words[at] != "MOTION":
        word = words[at]
        if word in ("ROOT", "JOINT"):
            parent = stack[-1] if stack else None
            joints.append({"parent": parent, "channels": [], "offset": np.zeros(3)})
            stack.append(len(joints) - 1)
            at += 3
        elif word == "End":
            stack.append(None)
            at += 3
        elif word == "OFFSET":
            if stack[-1] is not None:
                joints[stack[-1]]["offset"] = np.array(words[at + 1 : at + 4], float)
            at += 4
        elif word == "CHANNELS":
            count = int(words[at + 1])
            joints[stack[-1]]["channels"] = words[at + 2 : at + 2 + count]
            at += 2 + count
        else:
            assert word == "}", word
            stack.pop()
            at += 1
    frames = int(words[at + 2])
    values = np.array(words[at + 6 :], float).reshape(frames, -1)
    return joints, values


def about(axis, degrees):
    sine, cosine = np.sin(np.radians(degrees)), np.cos(np.radians(degrees))
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(3)
    matrix[i, i], matrix[i, j], matrix[j, i], matrix[j, j] = cosine, -sine, sine, cosine
    return matrix


def positions(joints, values):
    values, worlds = list(values), []
    for joint in joints:
        shift, turn = joint["offset"].copy(), np.eye(3)
        for channel in joint["channels"]:
            value, axis = values.pop(0), "XYZ".index(channel[0])
            if channel.endswith("position"):
                shift[axis] += value
            else:
                turn = turn @ about(axis, value)
        if joint["parent"] is not None:
            above_turn, above = worlds[joint["parent"]]
            shift, turn = above_turn @ shift + above, above_turn @ turn
        worlds.append((turn, shift))
    return [shift.tolist() for _, shift in worlds]


def main():
    joints, values = read(sys.argv[1])
    print(json.dumps([positions(joints, values[int(frame)]) for frame in sys.argv[2:]]))


main()
