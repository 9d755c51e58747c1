#!/usr/bin/python3
"""Kills runs at random moments, goes on from their checkpoints, and holds what comes of it to the
unbroken run: hashes, pictures, states, rows and report (as TAP).

usage: kills.py PROGRAM KILLS     at least so many kills, over all methods but one
"""
import json
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time

sys.argv[1:] or sys.exit("usage: kills.py PROGRAM KILLS")

SCENE = {
    "bodies": [{"cloth": {"grid": [12, 10], "bump": 0.01}, "mass": {"total": 1},
                "springs": {"stretch": 60, "damping": 0.05}, "pins": ["top"]}],
    "colliders": [{"sphere": {"centre": [0.5, -0.6, 0.1], "radius": 0.3}}],
    "contact": {"start": "move-out"},
    "events": [{"from": 0.05, "to": 0.4, "wind": {"direction": [0, 0, 1], "strength": 2}},
               {"from": 0.1, "to": 0.3, "impact": {"direction": [1, 0, 0], "impulse": 0.3}},
               {"at": 0.25, "release": {"particles": ["top-left"]}}],
    "render": {"size": [64, 48], "look": "strain"},
}
# of every kind first, then the others; shape matching takes bodies of its own
FIRST = ["velocity-verlet", "implicit-linearised", "bdf2", "dopri5", "xpbd", "newmark",
         "cvode-bdf", "fast-mass-spring"]
NOT = ["shape-matching"]
FRAMES, EVERY = 24, 5


def command(program, method, name, rest):
    return [program, "run", "s.json", "-n", str(FRAMES), "-i", method, "-q", "--renderer", "cpu",
            "--states", name + "-states", "--monitor", name + ".csv", "--export",
            "pc2,npz", *rest]


def survey(name):
    """The bytes of all outputs of a run; of its report all but the times."""
    found = {name_of: open(os.path.join(folder, name_of), "rb").read()
             for folder in (name, name + "-states") for name_of in os.listdir(folder)}
    found["csv"] = open(name + ".csv", "rb").read()
    report = json.loads(found.pop("run.json"))
    del report["seconds"]
    found.pop("run.checkpoint", None)
    # sizes and hashes are those of the files, of which times are a part
    found["manifest.txt"] = [line.split()[2] for line in found["manifest.txt"].decode().splitlines()
                             if line[0] != "#"]
    return found, report


def begin(program, method, name, alone):
    """The command that goes on with a run, or begins it; alone: in a process of its own."""
    rest = ["--isolate", "60"] if alone else []
    if os.path.exists(f"{name}/run.checkpoint"):
        return command(program, method, name, [*rest, "--resume", name])
    return command(program, method, name, [*rest, "-y", "-o", name, "--checkpoint", str(EVERY)])


def break_run(program, method, name, within, chance):
    """Kills and resumes until a run ends by itself; the number of kills, and what was wrong.
    within[method]: the seconds to kill in, which follow how fast the machine is at the time."""
    kills = 0
    while True:
        # what the other kind of death leaves behind must do no harm either
        process = subprocess.Popen(begin(program, method, name, kills % 2), stderr=subprocess.PIPE)
        try:
            process.wait(chance.uniform(0, within[method]) if kills < 12 else None)
            within[method] *= 0.8
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
            kills += 1
            within[method] *= 1.1
            continue
        message = process.stderr.read().decode()
        # the process that belonged to a killed one may take a moment to die
        if process.returncode == 4 and "another run is writing" in message:
            time.sleep(0.01)
            continue
        return kills, process.returncode, message


def main():
    program, wanted = os.path.realpath(sys.argv[1]), int(sys.argv[2])
    listed = subprocess.run([program, "integrators"], capture_output=True, text=True).stdout
    # names stand at the left, what is said of them further in
    listed = [line.split()[0] for line in listed.splitlines() if line[:1].isalpha()]
    methods = [m for m in FIRST if m in listed]
    methods += [m for m in listed if m not in FIRST + NOT]
    chance, failed, total, n = random.Random(1), 0, 0, 0
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        json.dump(SCENE, open("s.json", "w"))
        expected, within = {}, {}
        while total < wanted:
            method = methods[n % len(methods)]
            if method not in expected:
                start = time.monotonic()
                subprocess.run(command(program, method, "whole-" + method, [
                    "-o", "whole-" + method, "--checkpoint", str(EVERY)]), check=True)
                within[method] = time.monotonic() - start
                expected[method] = survey("whole-" + method)
            name, n = f"run-{n}", n + 1
            kills, code, message = break_run(program, method, name, within, chance)
            total += kills
            same = code == 0 and survey(name) == expected[method]
            left = [f for f in os.listdir(name) if ".tmp" in f]
            fine = same and not left
            failed += not fine
            print(f"{'ok' if fine else 'not ok'} {n} - {method}: {kills} kills")
            if fine:
                for kept in (name, name + "-states"):
                    shutil.rmtree(kept)
                os.remove(name + ".csv")
            else:
                print(f"# exit code {code} {message} left: {left}")
                if code == 0:
                    a, b = survey(name), expected[method]
                    print("#", [k for k in a[0] | b[0] if a[0].get(k) != b[0].get(k)],
                          [k for k in a[1] if a[1][k] != b[1].get(k)])
    print(f"# {total} kills\n1..{n}")
    return failed > 0


if __name__ == "__main__":
    sys.exit(main())
