#!/usr/bin/env python3
"""verdicts.py PROGRAM SCENES [PART] - one verdict over pairs of scene and method.

Each pair is run at default steps, once plainly and once with a ledger from its start. Counted are
pairs
  contradiction  with two verdicts, neither of which is "in doubt"
  dissipating    called unstable, although energy less what came in never rose
  unconfirmed    called globally unstable, where the ledger does not say so
  missed         that frames call bounded and the ledger unstable: frames know only how much wind and
                 events can have given at most
PART: only scenes with it in their name. Exit status 1 unless the first three are 0. A pair that takes
more than 40 s is left out, and counted as that."""
import csv
import json
import os
import subprocess
import sys
import tempfile

METHODS = ["", "symplectic-euler", "velocity-verlet", "position-verlet", "averaged-euler",
           "explicit-euler", "rk4", "backward-euler", "implicit-midpoint", "newmark",
           "tr-bdf2", "sdirk2", "ros2", "bdf2", "implicit-block", "fast-mass-spring", "xpbd",
           "dopri5", "cvode-bdf", "ark-imex", "gauss"]
SECONDS = 40  # of a run; pairs that take longer are left out
FRAMES = "20"
GAINS = ("drag", "wind", "friction", "events_force", "pins", "parameters", "strain_limit", "events")


def made_and_bound(path):
    """Most that the integrator made over the energy there was, by the ledger alone."""
    rows = [{k: float(v) for k, v in row.items()} for row in csv.DictReader(open(path))]
    first, balance, lowest, came, released, made, worst = rows[0], 0, 0, 0, 0, 0, 0
    for a, b in zip(rows, rows[1:]):
        gave = {k: b[k] - a[k] for k in b}
        came_now = sum(max(gave[k], 0) for k in GAINS)
        came_now += max(gave["projection"] + gave["absorption"], 0)
        came += came_now
        balance += gave["sum"] - came_now
        lowest = min(lowest, balance)
        made = max(made, balance - lowest)
        released = max(released, first["gravity"] - b["gravity"])
        bound = max(first["sum"] - first["gravity"] + released + came, 1e-12)
        worst = max(worst, (balance - lowest) / bound)
    return made, worst


def run(program, scene, method, folder, ledger):
    report, rows = os.path.join(folder, "r.json"), os.path.join(folder, "l.csv")
    command = [program, "run", scene, "--no-render", "-q", "-y", "-n", FRAMES, "--json", report]
    command += ["-i", method] if method else []
    command += ["--ledger", rows] if ledger else []
    try:
        subprocess.run(command, capture_output=True, timeout=SECONDS, check=True)
    except (subprocess.CalledProcessError, subprocess.TimeoutExpired):
        return None
    report = json.load(open(report))
    if report["outcome"] not in ("finished",):
        return {"verdict": report["outcome"]}
    return {"verdict": report["verdict"], "made": made_and_bound(rows) if ledger else None}


def main():
    program, scenes = os.path.abspath(sys.argv[1]), sys.argv[2]
    part = sys.argv[3] if len(sys.argv) > 3 else ""
    names = [os.path.join(at, f) for at, _, files in sorted(os.walk(scenes)) for f in sorted(files)
             if f.endswith(".json") and part in f and "extreme" not in at]
    count = {"pairs": 0, "left out": 0, "unstable": 0, "contradiction": 0, "dissipating": 0,
             "unconfirmed": 0, "missed": 0, "in doubt": 0}
    with tempfile.TemporaryDirectory() as folder:
        for scene in names:
            for method in METHODS:
                plain = run(program, scene, method, folder, False)
                full = plain and run(program, scene, method, folder, True)
                if not full:
                    count["left out"] += 1
                    continue
                count["pairs"] += 1
                unstable = "instability" in plain["verdict"]
                count["unstable"] += unstable
                found = []
                doubt = plain["verdict"] == "in doubt"
                count["in doubt"] += doubt
                if plain["verdict"] != full["verdict"] and not doubt and full["verdict"] != "in doubt":
                    found.append("missed" if plain["verdict"] == "bounded" else "contradiction")
                if unstable and full["made"] and not full["made"][0] > 0 and "global" in plain["verdict"]:
                    found.append("dissipating")
                if "global" in plain["verdict"] and full["made"] and not full["made"][1] > 1:
                    found.append("unconfirmed")
                for fault in found:
                    count[fault] += 1
                if found or unstable:
                    print(os.path.basename(scene), method or "default", plain["verdict"],
                          full["verdict"], full.get("made"), *found, flush=True)
    print(count)
    return any(count[k] for k in ("contradiction", "dissipating", "unconfirmed"))


sys.exit(main())
