#!/usr/bin/env python3
"""Prints the tables of docs/results/contact-methods.md: eight contacts by force, each by every method.

usage: contact_table.py PROGRAM [METHOD ...]

The page of docs/results has this output and a note by hand; all methods take ten minutes.

Each cell is one run of PROGRAM with the method's own step, held against a closed form or an
invariant that the head of its column says. "refused": the method may not; "-": it blew up or
gave up, with the time in s.
"""
import csv
import json
import math
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

G = 9.81
FLOOR = {"floor": {"height": 0}, "thickness": 0.002}
STILL = {"gravity": [0, 0, 0]}


def sheet(height, velocity=(0, 0, 0), shift=0.0, **keys):
    place = {"translate": [shift, height, 1.3 * shift]}
    cloth = {"grid": [8, 8], "size": [0.3, 0.3], "start": "flat", "place": place,
             "velocity": list(velocity)}
    return {"cloth": cloth, "mass": {"areal_density": 0.2}, "thickness": 0.002, **keys}


def force(**keys):
    return {"law": "force", **keys}


def ribbon(folder):
    """A strip of three particles across, half around a rod of 0.1 m along z, as OBJ."""
    radius, step, tail = 0.104, 0.01, 10
    turns = round(math.pi * radius / step)
    points = [(-radius, -step * k, 0) for k in range(tail, 0, -1)]
    points += [(-radius * math.cos(math.pi * k / turns), radius * math.sin(math.pi * k / turns), 0)
               for k in range(turns + 1)]
    points += [(radius, -step * k, 0) for k in range(1, tail + 1)]
    lines = [f"v {x:.9g} {y:.9g} {step * (c - 1):.9g}" for x, y, _ in points for c in range(3)]
    for row in range(len(points) - 1):
        for c in range(2):
            a = 3 * row + c + 1
            lines += [f"f {a} {a + 3} {a + 1}", f"f {a + 1} {a + 3} {a + 4}"]
    (folder / "ribbon.obj").write_text("\n".join(lines) + "\n")
    return 3 * len(points)


def capstan(folder, ratio):
    """Pulled by 1 N on one side and by the ratio on the other; it holds below e^(mu pi)."""
    n = ribbon(folder)
    ends = ((range(3), 1.0), (range(n - 3, n), ratio))
    pulls = [{"from": 0, "to": 1, "impact": {"particles": [{"index": i} for i in side],
                                             "direction": [0, -1, 0], "impulse": newton}}
             for side, newton in ends]
    return {"bodies": [{"mesh": {"file": "ribbon.obj"}, "mass": {"areal_density": 0.2},
                        "springs": {"stretch": 2000, "shear": 500, "bend": 1, "damping": 0.005}}],
            "forces": STILL, "contact": force(stiffness=2000), "events": pulls,
            "colliders": [{"capsule": {"from": [0, 0, -0.2], "to": [0, 0, 0.2], "radius": 0.1},
                           "friction": 0.2, "thickness": 0.004}]}


class Run:
    def __init__(self, program, scene, method, frames, folder):
        path = folder / "scene.json"
        path.write_text(json.dumps(scene))
        command = [program, "run", path, "-n", frames, "--no-render", "-q", "-i", method,
                   "--monitor", folder / "m.csv", "--states", folder / "s",
                   "--json", folder / "r.json"]
        done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
        self.why = ""
        if done.returncode:
            self.why = "refused" if done.returncode in (2, 3) else f"exit {done.returncode}"
            return
        with open(folder / "m.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.energy = [float(row["energy"]) for row in rows]
        if len(rows) <= frames:
            self.why = f"- {float(rows[-1]['t']):.2g}"
        self.first, self.last = (self.state(folder, k) for k in (0, len(rows) - 1))

    @staticmethod
    def state(folder, frame):
        """Positions and velocities of a frame: two lists of (x, y, z)."""
        out = []
        for name in "xv":
            raw = (folder / "s" / f"{name}_{frame:05d}.npy").read_bytes()
            values = memoryview(raw[10 + int.from_bytes(raw[8:10], "little"):]).cast("d")
            out.append([tuple(values[k:k + 3]) for k in range(0, len(values), 3)])
        return out


def mean(vectors, axis):
    return sum(v[axis] for v in vectors) / len(vectors)


def most(run):
    return f"{max(run.energy) / run.energy[0]:.3f}"


def bounce(run):
    return f"{-mean(run.last[1], 1) / mean(run.first[1], 1):.2f}"


def slide(run):
    return f"{mean(run.last[0], 0) - mean(run.first[0], 0):.3f}"


def apart(run):
    first, last = run.first[1], run.last[1]
    half = len(first) // 2
    def along(v):
        return mean(v[:half], 1) - mean(v[half:], 1)
    leak = max(abs(mean(last, axis) - mean(first, axis)) for axis in range(3))
    return f"{-along(last) / along(first):.2f}, {leak:.0e}"


def drawn(run):
    return f"{abs(run.last[1][-1][1]):.2g}"


SCENES = (
    ("rest", "k = 2e5 N/m, 0.5 s: largest energy over the first, 1", 30, most, lambda _: {
        "bodies": [sheet(0.002)], "contact": force(stiffness=2e5), "colliders": [FLOOR]}),
    ("drop", "by 5 mm, 0.5 s: the same, 1", 30, most, lambda _: {
        "bodies": [sheet(0.007)], "contact": force(), "colliders": [FLOOR]}),
    ("throw", "at 5 m/s, `restitution` 0.5: speed after over before, 0.5", 12, bounce, lambda _: {
        "bodies": [sheet(0.117, (0, -5, 0))], "forces": STILL,
        "contact": force(restitution=0.5), "colliders": [FLOOR]}),
    ("clash", "two sheets at 2 m/s, `restitution` 0.5: the same, 0.5, and mean velocity made, m/s",
     12, apart, lambda _: {
         "bodies": [sheet(0.05, (0, -2, 0)), sheet(-0.05, (0, 2, 0), 0.01)], "forces": STILL,
         "contact": force(restitution=0.5), "pairs": {"list": [{"bodies": [0, 1]}]}}),
    ("slide", "lands at 2 m/s along a floor, mu = 0.4: way in m, v^2/(2 mu g) = 0.510", 60, slide,
     lambda _: {"bodies": [sheet(0.0025, (2, 0, 0))], "contact": force(),
                "colliders": [{**FLOOR, "friction": 0.4}]}),
    ("belt", "a floor at 0.5 m/s, mu = 0.4: way in 1 s in m, 0.468", 60, slide, lambda _: {
        "bodies": [sheet(0.002)], "contact": force(), "colliders": [{**FLOOR, "friction": 0.4}],
        "events": [{"from": 0, "to": 1, "move": {"collider": 0, "motion": "linear", "path": [
            {"at": 1, "point": [0.5, 0, 0]}]}}]}),
    ("holds", "half around a rod, mu = 0.2, e^(mu pi) = 1.87: m/s of the end that 1.7 N pull against 1 N, after 0.2 s", 12,
     drawn, lambda folder: capstan(folder, 1.7)),
    ("slips", "the same by 2.1 to 1 N", 12, drawn, lambda folder: capstan(folder, 2.1)),
)


def row(program, method):
    cells = []
    for _, _, frames, judge, build in SCENES:
        with tempfile.TemporaryDirectory() as name:
            run = Run(program, build(Path(name)), method, frames, Path(name))
            cells.append(run.why or judge(run))
    return f"| {method} | " + " | ".join(cells) + " |"


def main():
    if len(sys.argv) < 2 or not Path(sys.argv[1]).is_file():
        sys.exit("usage: contact_table.py PROGRAM [METHOD ...]")
    program, methods = sys.argv[1], sys.argv[2:]
    if not methods:
        listed = subprocess.run([program, "integrators"], capture_output=True, text=True, check=True)
        methods = [line.split()[0] for line in listed.stdout.splitlines() if line[:1].isalpha()]
    print("# Contact: eight scenes by every method\n\nMade by `tools/contact_table.py`; methods at "
          "their own step. refused: the method may not;\n- and a time in s: it blew up or gave up "
          "there.\n\n| column | scene, and what is in it |\n|---|---|")
    for name, what, *_ in SCENES:
        print(f"| {name} | {what} |")
    print("\n| method | " + " | ".join(scene[0] for scene in SCENES) + " |")
    print("|---|" + "---|" * len(SCENES))
    with ThreadPoolExecutor(2) as pool:
        for line in pool.map(lambda method: row(program, method), methods):
            print(line, flush=True)


if __name__ == "__main__":
    main()
