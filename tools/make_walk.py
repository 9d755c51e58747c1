#!/usr/bin/env python3
"""make_walk.py PROGRAM - writes scenes/bear_walk.pc2: one cycle of two steps of the shape `limbs`
with detail 14, in place, as key frames for a loop. PROGRAM is clothsim, which exports the shape.

Each vertex follows the trunk, the head, the arms, the legs and the feet, each rigid, by weights
that fade with the distance from their ellipsoids (those of src/mesh/trimesh_metaballs.c)."""
import glob
import json
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

KEYS, STRIDE, LIFT = 16, 0.16, 0.05  # STRIDE: m that a foot goes back on the ground

# centre and radii of the ellipsoids of each part on the right; x is mirrored on the left
PARTS = {"trunk": [(0, -0.13, 0, 0.19, 0.23, 0.16)],
         "head": [(0, 0.235, 0, 0.155, 0.145, 0.14), (0, 0.20, 0.135, 0.06, 0.05, 0.055),
                  (0.13, 0.375, -0.01, 0.07, 0.07, 0.045), (-0.13, 0.375, -0.01, 0.07, 0.07, 0.045)],
         "arm": [(0.20, 0.01, 0.02, 0.10, 0.07, 0.065), (0.33, 0.03, 0.04, 0.075, 0.062, 0.06)],
         "leg": [(0.12, -0.32, 0.02, 0.075, 0.10, 0.075)],
         "foot": [(0.13, -0.425, 0.07, 0.075, 0.055, 0.10)]}
HIP, ANKLE, SHOULDER, NECK = (0.12, -0.27, 0.0), (0.13, -0.40, 0.03), (0.15, 0.03, 0.0), (0, 0.1, 0)


def bear(program):
    """vertices (n, 3) of the shape"""
    scene = {"bodies": [{"cloth": {"grid": [2, 2], "place": {"translate": [0, 9, 0]}},
                         "mass": {"total": 1}}],
             "colliders": [{"mesh": {"shape": "limbs", "detail": 14}}], "contact": "force"}
    with tempfile.TemporaryDirectory() as folder:
        with open(f"{folder}/bear.json", "w") as out:
            json.dump(scene, out)
        subprocess.run([program, "run", f"{folder}/bear.json", "--frames", "1", "--no-render",
                        "--export", "obj", "-o", f"{folder}/out"], check=True, capture_output=True)
        name = sorted(glob.glob(f"{folder}/out/**/colliders*.obj", recursive=True))[0]
        lines = [line.split() for line in open(name)]
    return np.array([[float(x) for x in line[1:]] for line in lines if line[:1] == ["v"]])


def turn(axis, degrees):
    a = np.radians(degrees)
    m = np.eye(3)
    u, v = (axis + 1) % 3, (axis + 2) % 3
    m[u, u] = m[v, v] = np.cos(a)
    m[u, v], m[v, u] = -np.sin(a), np.sin(a)
    return m


def about(centre, matrix, shift=(0, 0, 0)):
    """a rigid motion as a function of points"""
    centre = np.array(centre)
    return lambda p: (p - centre) @ matrix.T + centre + np.array(shift)


def weights(places):
    """of the parts at each vertex, with both sides of those that come in pairs"""
    found = {}
    for name, blobs in PARTS.items():
        for side in (1, -1) if name in ("arm", "leg", "foot") else (1,):
            near = np.full(len(places), np.inf)
            for b in blobs:
                d = (places - np.array(b[:3]) * (side, 1, 1)) / b[3:]
                near = np.minimum(near, np.einsum("ij,ij->i", d, d))
            found[name, side] = np.exp(-2.5 * near)
    total = sum(found.values())
    return {key: w / total for key, w in found.items()}


def foot_path(angle):
    """forwards and up: three terms of a triangle wave, so that the speed on the ground is nearly
    constant, and lifted on the way forwards"""
    along = sum(np.cos(k * angle) / k**2 for k in (1, 3, 5)) / sum(1 / k**2 for k in (1, 3, 5))
    return STRIDE / 2 * along, LIFT * max(0.0, -np.sin(angle)) ** 2


def pose(places, share, phase):
    """positions at a phase of the cycle from 0 to 1"""
    angle = 2 * np.pi * phase
    down = 0.012 * np.cos(2 * angle)
    body = turn(2, 3 * np.sin(angle)) @ turn(1, 5 * np.cos(angle))
    motions = {("trunk", 1): about((0, -0.25, 0), body, (0.008 * np.sin(angle), down, 0)),
               ("head", 1): about(NECK, turn(0, 4 * np.sin(2 * angle)) @ turn(2, -2 * np.sin(angle)),
                                  (0.012 * np.sin(angle), down, 0))}
    for side in (1, -1):
        mirror = np.array((side, 1, 1))
        along, up = foot_path(angle if side > 0 else angle + np.pi)
        hip, ankle = HIP * mirror, ANKLE * mirror
        swing = np.degrees(np.arctan2(along, 0.13))
        toes = 18 * np.clip(-along / STRIDE, -0.4, 1) + 260 * up
        motions["leg", side] = about(hip, turn(0, -swing), (0, 0.4 * up + down, 0))
        motions["foot", side] = about(ankle, turn(0, toes), (0, up, along))
        arm = turn(0, 22 * np.cos(angle) * side) @ turn(2, -28 * side)
        motions["arm", side] = about(SHOULDER * mirror, body @ arm, (0, down, 0))
    return sum(share[key][:, None] * move(places) for key, move in motions.items())


def main():
    if len(sys.argv) != 2 or not Path(sys.argv[1]).is_file():
        sys.exit("usage: make_walk.py PROGRAM")
    places = bear(sys.argv[1])
    share = weights(places)
    with open("scenes/bear_walk.pc2", "wb") as out:
        out.write(struct.pack("<12siiffi", b"POINTCACHE2", 1, len(places), 0, 1, KEYS))
        for k in range(KEYS):
            out.write(pose(places, share, k / KEYS).astype("<f4").tobytes())


if __name__ == "__main__":
    main()
