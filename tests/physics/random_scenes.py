#!/usr/bin/python3
"""Runs random scenes that name bodies and colliders and nothing else, and holds them to what holds
without a key set (as TAP): no particle is inside a collider, the run ends with its last frame and
is bounded, and pictures taken more often show the same motion, where a motion can be told: beyond
the horizon two runs at small tolerances part as well. Crossings of a body with itself are none of
these: bodies that name no self_contact go through themselves.

usage: random_scenes.py PROGRAM SCENES EACH
       SCENES scenes by the default method, the first EACH of them by every other one
"""
import json
import random
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

SECONDS = 0.5
# cells along a sheet, at most
SHORT, LONG = 20, 60
# m per m of the scene's size
DEPTH = 1e-3
MOTION = 1e-2
# tolerances, and the distance of their motions that a horizon leaves, per size
FINE = (1e-5, 1e-6)
HORIZON = 1e-3
# what cannot take these scenes, by its nature: an unstable method, one for motion without
# contact, one for bodies with clusters
REFUSED = {"explicit-euler", "averaged-euler", "symmetric-multistep", "shape-matching"}


def body_of(draw, kind, size, cells):
    if kind in ("ball", "box"):
        return {"mesh": {"shape": "sphere" if kind == "ball" else "box", "detail": 3,
                         "scale": [size / 4] * 3}, "mass": {"total": round(size ** 3, 9)},
                "network": {}}
    rows = cells if kind == "sheet" else max(3, cells // 4)
    return {"cloth": {"grid": [cells, rows], "size": [size, size * rows / cells], "start": "flat"},
            "mass": {"total": round(0.2 * size * size * rows / cells, 9)}}


def colliders_of(kind, r):
    """Colliders of a size of r at the origin, and the height of their top."""
    sphere = {"sphere": {"centre": [0, 0, 0], "radius": r}}
    return {"sphere": ([sphere], r),
            "box": ([{"box": {"centre": [0, 0, 0], "size": [2 * r, r, 1.5 * r]}}], r / 2),
            "capsule": ([{"capsule": {"from": [-3 * r, 0, 0], "to": [3 * r, 0, 0],
                                      "radius": r / 2}}], r / 2),
            "floor": ([{"floor": {"height": 0}}], 0),
            "two": ([sphere, {"floor": {"height": -1.2 * r}}], r),
            "mesh": ([{"mesh": {"shape": "sphere", "detail": 4, "scale": [r] * 3}}], r)}[kind]


def scene_of(seed, largest):
    draw = random.Random(seed)
    cells = draw.randint(5, largest)
    size = draw.choice((0.2, 0.5, 1, 1, 2))
    body = body_of(draw, draw.choice(("sheet", "sheet", "strip", "ball", "box")), size, cells)
    r = size * draw.uniform(0.15, 0.35)
    colliders, top = colliders_of(draw.choice(("sphere", "box", "capsule", "floor", "two", "mesh")),
                                  r)
    lift = size / 4 if "mesh" in body else 0
    drop = draw.choice((0.05, 0.1, 0.3, 1)) * size
    shape = body.get("mesh") or body["cloth"]
    shape["place"] = {"translate": [draw.uniform(-0.1, 0.1) * size, top + lift + drop,
                                    draw.uniform(-0.1, 0.1) * size]}
    scene = {"bodies": [body], "colliders": colliders}
    if draw.random() < 0.2:
        shape["velocity"] = [draw.uniform(-1, 1) * size, 0, 0]
    if draw.random() < 0.2 and "floor" not in colliders[0]:
        scene["events"] = [{"from": 0, "to": 1, "move": {
            "collider": 0, "relative": True, "path": [{"at": 1, "point": [0, 0.3 * size, 0]}]}}]
    return scene, size


def depth_in(x, collider, shift):
    """The largest depth in m of positions (n,3) in a collider that has moved by shift."""
    kind, keys = next((k, v) for k, v in collider.items())
    x = x - shift
    if kind == "floor":
        return (keys["height"] - x[:, 1]).max()
    if kind == "sphere":
        return (keys["radius"] - np.linalg.norm(x - keys["centre"], axis=1)).max()
    if kind == "capsule":
        a, b = np.array(keys["from"]), np.array(keys["to"])
        along = np.clip(((x - a) @ (b - a)) / ((b - a) @ (b - a)), 0, 1)
        return (keys["radius"] - np.linalg.norm(x - a - along[:, None] * (b - a), axis=1)).max()
    if kind == "box":
        # its edges are round, by the radius that clothsim-scene(5) states
        half = np.array(keys["size"]) / 2
        radius = 0.05 * min(keys["size"])
        q = abs(x - keys["centre"]) - (half - radius)
        outside = np.linalg.norm(np.maximum(q, 0), axis=1)
        return (radius - outside - np.minimum(q.max(axis=1), 0)).max()
    # a mesh of a ball of radius 1/2, whose facets lie within 2 % of the radius inside it
    return (0.98 * 0.5 * keys["scale"][0] - np.linalg.norm(x, axis=1)).max()


def run(program, folder, scene, size, method, fps):
    """What went wrong, or None; and the positions after SECONDS."""
    Path(folder, "s.json").write_text(json.dumps({**scene, "time": {"fps": fps}}))
    frames = round(SECONDS * fps)
    done = subprocess.run(
        [program, "run", "s.json", "-y", "-q", "-n", str(frames), "--no-render", "-i", method,
         "-o", "o", "--states", "x", "--json", "r.json"], cwd=folder, capture_output=True, text=True)
    if done.returncode:
        return done.stderr.strip()[-200:], None
    report = json.loads(Path(folder, "r.json").read_text())
    if report["outcome"] != "finished":
        return f"{report['outcome']}: {done.stderr.strip()[-200:]}", None
    if report["verdict"] not in ("bounded", "beyond cloth"):
        return report["verdict"], None
    velocity = np.array([e["move"]["path"][0]["point"] for e in scene.get("events", [])])
    for k in range(frames + 1):
        x = np.load(Path(folder, "x", f"x_{k:05}.npy"))
        for c, collider in enumerate(scene["colliders"]):
            shift = velocity[0] * k / fps if len(velocity) and c == 0 else np.zeros(3)
            depth = depth_in(x, collider, shift)
            if depth > DEPTH * size:
                return f"{depth:.3g} m deep in colliders[{c}] at frame {k}", None
    return None, x


def apart(a, b, size):
    return np.sqrt(((a - b) ** 2).sum(1).mean()) / size


def is_beyond_horizon(program, folder, scene, size):
    ends = [run(program, folder, scene, size, f"dopri5:rtol={rtol}", 24)[1] for rtol in FINE]
    return all(x is not None for x in ends) and apart(*ends, size) > HORIZON


def main():
    if len(sys.argv) != 4 or not Path(sys.argv[1]).is_file() or \
            not (sys.argv[2] + sys.argv[3]).isdigit():
        sys.exit("usage: random_scenes.py PROGRAM SCENES EACH, a program and two counts")
    program, scenes, each = str(Path(sys.argv[1]).resolve()), int(sys.argv[2]), int(sys.argv[3])
    listed = subprocess.run([program, "integrators"], capture_output=True, text=True).stdout
    others = [line.split()[0] for line in listed.splitlines() if line[:1].strip()]
    others = [name for name in others if name not in REFUSED]
    tests = 0
    for seed in range(scenes):
        scene, size = scene_of(seed, SHORT if scenes <= 20 else LONG)
        for method in ["automatic"] + (others if seed < each else []):
            with tempfile.TemporaryDirectory() as folder:
                wrong, often = run(program, folder, scene, size, method, 240)
                if not wrong and method == "automatic":
                    wrong, seldom = run(program, folder, scene, size, method, 24)
                    moved = 0 if wrong else apart(often, seldom, size)
                    if moved > MOTION and not is_beyond_horizon(program, folder, scene, size):
                        wrong = f"at 24 and 240 frames per second {moved:.2g} of the size apart"
            tests += 1
            print(("not ok" if wrong else "ok"), tests, f"- scene {seed} by {method}" +
                  (f": {wrong}" if wrong else ""), flush=True)
    print(f"1..{tests}")


if __name__ == "__main__":
    main()
