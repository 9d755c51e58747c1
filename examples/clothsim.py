# SPDX-License-Identifier: MIT
"""Runs clothsim from Python and reads what it writes, by NumPy alone.

>>> import clothsim
>>> run = clothsim.run("scenes/hang.json", set={"forces.drag": 0.01}, integrator="rk4", frames=30)
>>> run.x.shape, run.report["outcome"]

The program is `clothsim` of the search path, or what the variable CLOTHSIM names.
"""
import csv
import json
import os
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Optional

import numpy as np

__all__ = ["Run", "load_run", "load_compare", "run"]

# columns of compare.csv that are texts, and flags; all others are numbers
TEXTS = frozenset(("series", "method", "fixed", "options", "family", "control", "outcome", "note",
                   "key", "state_hash", "module", "machine", "version"))
FLAGS = frozenset(("adaptive",))


@dataclass
class Run:
    """Samples of a run: F of them, of n particles and T faces."""
    x: np.ndarray  # positions in m (F, n, 3)
    v: np.ndarray  # velocities in m/s (F, n, 3)
    faces: Optional[np.ndarray]  # particles of each triangle (T, 3); None: only states are there
    times: np.ndarray  # s (F)
    report: dict  # run.json: see clothsim-files(5)


def _states(folder: Path, letter: str, numbers: list) -> np.ndarray:
    return np.stack([np.load(folder / f"{letter}_{number:05d}.npy") for number in numbers])


def load_run(folder) -> Run:
    """Reads the folder of `clothsim run --json FOLDER/run.json`, or one with pictures, and with
    `--export npz -o FOLDER` or `--states FOLDER`. FileNotFoundError if it has no states."""
    folder = Path(folder)
    report = json.loads((folder / "run.json").read_text(encoding="utf-8"))
    archive = folder / "run.npz"
    if archive.exists():
        with np.load(archive) as samples:
            return Run(samples["positions"], samples["velocities"], samples["faces"],
                       samples["times"], report)
    numbers = [k for k in range(report["frames_done"] + 1) if (folder / f"x_{k:05d}.npy").exists()]
    if not numbers:
        raise FileNotFoundError(f"{folder} has neither run.npz nor states: run with "
                                "--export npz or --states")
    times = np.array(numbers) / report["scene"]["time"]["fps"]
    return Run(_states(folder, "x", numbers), _states(folder, "v", numbers), None, times, report)


def _column(name: str, fields: list) -> np.ndarray:
    if name in TEXTS:
        return np.array(fields, dtype=str)
    if name in FLAGS:
        return np.array([field == "1" for field in fields], dtype=bool)
    return np.array([float(field) if field else np.nan for field in fields])


def load_compare(path) -> dict:
    """Reads compare.csv, or the one in a folder: an array for each column of clothsim-files(5),
    with nan for an empty number. Rows are in the order of the file."""
    path = Path(path)
    with open(path / "compare.csv" if path.is_dir() else path, newline="", encoding="utf-8") as file:
        names, *rows = csv.reader(file)
    if rows and any(len(row) != len(names) for row in rows):
        raise ValueError(f"{path}: a row is not whole; was it interrupted?")
    return {name: _column(name, [row[k] for row in rows])
            for k, name in enumerate(names) if name != "check"}


def _text(value: Any) -> str:
    """A value of --set: texts as they are, all else as JSON."""
    if isinstance(value, str):
        return value
    return json.dumps(value.tolist() if isinstance(value, (np.ndarray, np.generic)) else value)


def run(scene, set: Optional[dict] = None, integrator: Optional[str] = None, frames: int = 60,
        folder=None) -> Run:
    """Runs a scene without pictures: a path, or the scene itself as a dict, whose files are then
    sought in the working folder. `set` has values by path ("bodies[0].springs.stretch": 200);
    `integrator` is "NAME:key=value,...". Files stay in `folder` if one is named, which is
    overwritten. A run that blows up is a result: see report["outcome"]. RuntimeError with the
    program's message if the scene cannot be run."""
    with tempfile.TemporaryDirectory() as temporary:
        into = Path(folder or temporary)
        into.mkdir(parents=True, exist_ok=True)
        words = [os.environ.get("CLOTHSIM", "clothsim"), "run",
                 "-" if isinstance(scene, dict) else str(scene), "--frames", str(frames),
                 "--no-render", "--quiet", "--overwrite", "--export", "npz", "--out", str(into),
                 "--json", "-"]
        for path, value in (set or {}).items():
            words += ["--set", f"{path}={_text(value)}"]
        if integrator:
            words += ["--integrator", integrator]
        done = subprocess.run(words, input=json.dumps(scene) if isinstance(scene, dict) else None,
                              stdin=None if isinstance(scene, dict) else subprocess.DEVNULL,
                              capture_output=True, encoding="utf-8", check=False)
        if done.returncode:
            raise RuntimeError(done.stderr.strip() or f"clothsim ended with {done.returncode}")
        (into / "run.json").write_text(done.stdout, encoding="utf-8")
        return load_run(into)
