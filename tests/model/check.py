#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""check.py PROGRAM SCENE [forces] - the program beside model.py on a scene of this folder.

Forces at the frames of a run within 1e-10 N and, unless "forces" is asked for alone, positions after
half of it within 1e-10 m: the model is slow, the program is not, so forces are compared at more states and
for longer. Exit status 1 if either differs by more, 99 if they cannot be compared.
"""
import os
import subprocess
import sys
import tempfile
import traceback
from pathlib import Path

sys.argv[1:] or sys.exit("usage: check.py PROGRAM SCENE [forces]")


def end(*what):
    """Ends with 99 for any exception: a planted fault is found by a difference and by nothing else."""
    traceback.print_exception(*what)
    os._exit(99)


sys.excepthook = end
import numpy as np

from model import Model

FPS, FRAMES, NEAR = 240, 8, 1e-10
program, name = sys.argv[1:3]
path = Path(__file__).parent / "scenes" / f"{name}.json"
with tempfile.TemporaryDirectory() as folder:
    ran = subprocess.run([program, "run", path, "-s", f"time.fps={FPS}", "-n", str(FRAMES), "--no-render", "-q", "-o", folder,
                    "-i", "dopri5:rtol=1e-13,atol=1e-15", "--export", "npz", "--export-values", "force"])
    if ran.returncode:
        sys.exit(99)  # no program, no fault found
    run = np.load(f"{folder}/run.npz")
model, forces = Model(path), []
for x, v, f in zip(run["positions"], run["velocities"], run["forces"]):
    own = model.force(np.concatenate([x, model.x[model.n:]]), np.concatenate([v, model.v[model.n:]]))
    forces.append(np.abs(own[:model.n] - f)[model.free].max())
half = run["positions"][FRAMES // 2]
apart = 0 if sys.argv[3:] == ["forces"] else np.abs(model.run(FRAMES / 2 / FPS) - half).max()
moved = np.abs(half - run["positions"][0]).max()
good = max(forces) < NEAR and apart < NEAR
print(f"{'ok' if good else 'not ok'} - {name}: forces {max(forces):.1e} N, positions {apart:.1e} m apart "
      f"after a way of {moved:.2g} m")
sys.exit(not good)
