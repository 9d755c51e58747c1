#!/usr/bin/env python3
"""Prints the table of docs/notes/fitted-orders.md: the order of every method on five scenes.

usage: fitted_orders.py PROGRAM [METHOD ...]

The page of docs/notes has this output and notes by hand; all methods take ten minutes.

The error is that of the last positions, the root of the mean square in m against dop853 at a
tolerance of 1e-13. Fixed steps are halved three times from one that depends on the order claimed,
tolerances divided by ten; the order is the slope of log(error) against log(time / steps)
over the last three runs that err by 1e-13 to 1e-2 m. "-": fewer than three did, and methods of
variable order; "refused": the method may not.
"""
import json
import math
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

SECONDS, FPS = 0.4, 5
PINS = ["top-left", "top-right"]
SPRINGS = {"stretch": 20, "shear": 6, "bend": 0.6}


def sheet(**keys):
    body = {"cloth": {"grid": [6, 6], "size": [0.5, 0.5], "start": "flat", "bump": 0.02},
            "mass": {"areal_density": 0.2}, "springs": SPRINGS, "pins": PINS}
    return {key: value for key, value in (body | keys).items() if value is not None}


MEMBRANE = {"membrane": {"young": 20, "poisson": 0.3},
            "bending": {"stiffness": 1e-3, "damping": 0.01}, "damping": 0.01}
# a sheet in the range of a ball, on which it slides
RUBBED = sheet(pins=None, cloth={"grid": [6, 6], "size": [0.5, 0.5], "start": "flat",
                                 "place": {"translate": [0.05, 0.04, 0]}})
SCENES = {
    "smooth": {"bodies": [sheet()]},
    "damped": {"bodies": [sheet(springs=SPRINGS | {"damping": 0.02})], "forces": {"drag": 0.002}},
    "membrane": {"bodies": [sheet(springs=None, elastic=MEMBRANE)]},
    "contact": {"bodies": [RUBBED],
                "colliders": [{"sphere": {"centre": [0, -0.5, 0], "radius": 0.5}, "thickness": 0.06,
                               "friction": 0.4}],
                "contact": {"law": "force", "stiffness": 20, "damping": 0.01,
                            "friction_speed": 0.3}},
    "moving pins": {"bodies": [sheet()],
                    "events": [{"from": 0, "to": 9, "grab": {
                        "body": 0, "particles": ["top-left"],
                        "path": [{"at": 9, "point": [0.65, 1.8, -1.15]}]}}]},
}
DAMPED = set(SCENES) - {"smooth", "moving pins"}
# what else a method needs, so that its iterations leave less than its steps do
MORE = {"iterations": 100, "newton_rtol": 1e-9, "linear_rtol": 1e-9}
FIXED = {1: 1 / 640, 2: 1 / 320, 4: 1 / 160, 8: 1 / 640}


def claims(program):
    listed = subprocess.run([program, "integrators", "--json", "-"], capture_output=True, text=True,
                            check=True).stdout
    return {method["name"]: method for method in json.loads(listed)}


def run(program, folder, scene, method):
    """Returns the last positions and the steps; None, "refused" or "-" if there are none."""
    name = method.replace(":", "_").replace(",", "_")[:120]
    out = Path(folder) / name / scene.replace(" ", "_")
    out.mkdir(parents=True, exist_ok=True)
    path = out / "scene.json"
    path.write_text(json.dumps(SCENES[scene] | {"time": {"fps": FPS}}))
    done = subprocess.run([program, "run", path, "-t", str(SECONDS), "--no-render", "-q", "-y",
                           "--export", "npz", "--json", out / "report.json", "-o", out / "run",
                           "-i", method], capture_output=True, text=True, check=False)
    if done.returncode:
        return None, "refused: " + done.stderr.strip()
    report = json.loads((out / "report.json").read_text())
    if report["outcome"] != "finished":
        return None, "-"
    with np.load(out / "run" / "run.npz") as found:
        return found["positions"][-1], report["counts"]["steps"]


def series(method):
    """Options of the runs of a method, coarse to fine."""
    names = {option["name"] for option in method["options"]}
    more = "".join(f",{key}={value:g}" for key, value in MORE.items() if key in names)
    if "adaptive" in method["traits"] and "multistep" in method["traits"]:
        return []
    if "adaptive" in method["traits"]:
        return [f"{method['name']}:rtol={10.0**-k:g}{more}" for k in range(4, 9)]
    if "rtol" in names:
        more += ",rtol=1e-11"
    first = FIXED[max(order for order in FIXED if order <= max(method["order"], 1))]
    return [f"{method['name']}:dt={first / 2**k:.12g}{more}" for k in range(4)]


def fitted(program, folder, scene, method, reference):
    points = []
    for text in series(method):
        x, steps = run(program, folder, scene, text)
        if x is None and steps.startswith("refused"):
            print(text, steps, file=sys.stderr)
            return "refused"
        if x is not None:
            error = math.sqrt(np.mean(np.sum((x - reference) ** 2, axis=1)))
            points.append((math.log(SECONDS / steps), error))
    good = [(h, math.log(error)) for h, error in points if 1e-13 < error < 1e-2][-3:]
    if len(good) < 3:
        return "-"
    return f"{np.polyfit(*zip(*good), 1)[0]:.2f}"


def main():
    if len(sys.argv) < 2 or not Path(sys.argv[1]).is_file():
        sys.exit("usage: fitted_orders.py PROGRAM [METHOD ...]")
    program = sys.argv[1]
    methods = claims(program)
    print("| method | claimed | " + " | ".join(SCENES) + " |\n|" + " --- |" * (2 + len(SCENES)))
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(5) as pool:
        exact = {scene: run(program, folder, scene, "dop853:rtol=1e-13,atol=1e-15")[0]
                 for scene in SCENES}
        for name in sys.argv[2:] or methods:
            method = methods[name]
            cells = pool.map(lambda scene, m=method: fitted(program, folder, scene, m,
                                                            exact[scene]), SCENES)
            claimed = (f"{method['order']}" if method["order"] == method["order_damped"]
                       else f"{method['order']}, {method['order_damped']} damped")
            print(f"| {name} | {claimed} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
