#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""check.py PROGRAM [SCENE ...] - the program beside model.py on the scenes of this folder.

Of each scene: forces at the frames of a run within 1e-10 N; without a SCENE, positions after it
within 1e-10 m too. Exit status 1 if any differs by more.
"""
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from model import Model

FRAMES, NEAR = 2, 1e-10
scenes = Path(__file__).parent / "scenes"
failed = 0
for path in [scenes / f"{name}.json" for name in sys.argv[2:]] or sorted(scenes.glob("*.json")):
    with tempfile.TemporaryDirectory() as folder:
        ran = subprocess.run([sys.argv[1], "run", path, "-n", str(FRAMES), "--no-render", "-q", "-o", folder,
                        "-i", "dopri5:rtol=1e-13,atol=1e-15", "--export", "npz", "--export-values", "force"])
        if ran.returncode:
            sys.exit(99)  # no program, no fault found
        run = np.load(f"{folder}/run.npz")
    model, forces = Model(path), []
    for x, v, f in zip(run["positions"], run["velocities"], run["forces"]):
        own = model.force(np.concatenate([x, model.x[model.n:]]), np.concatenate([v, model.v[model.n:]]))
        forces.append(np.abs(own[:model.n] - f)[model.free].max())
    apart = 0 if sys.argv[2:] else np.abs(model.run(FRAMES) - run["positions"][-1]).max()
    moved = np.abs(run["positions"][-1] - run["positions"][0]).max()
    good = max(forces) < NEAR and apart < NEAR
    failed += not good
    print(f"{'ok' if good else 'not ok'} - {path.stem}: forces {max(forces):.1e} N, positions {apart:.1e} m apart "
          f"after a way of {moved:.2g} m", flush=True)
sys.exit(failed > 0)
