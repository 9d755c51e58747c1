# SPDX-License-Identifier: MIT
"""Runs clothsim from Python and reads what it writes, by NumPy alone.

>>> import clothsim
>>> run = clothsim.run("scenes/hang.json", set={"forces.drag": 0.01}, integrator="rk4", frames=30)
>>> run.x.shape, run.report["outcome"]
>>> clothsim.compare("scenes/drum.json", ["rk4", "tr-bdf2:dt=1e-3..2e-2"])
>>> clothsim.picture("scenes/hang.json", frame=30)

Tables are a pandas.DataFrame where pandas is there, else a list of dicts.

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

__all__ = ["Picture", "Run", "advise", "compare", "conform", "force_length", "frequencies", "load_compare", "load_run",
           "picture", "plot", "run", "spectrum", "stability"]

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
        words = ["--frames", frames, "--no-render", "--overwrite", "--export", "npz", "--out", into, "--json", "-"]
        report = _call("run", scene, words + (["--integrator", integrator] if integrator else []), set)
        (into / "run.json").write_text(report, encoding="utf-8")
        return load_run(into)


def _call(command: str, scene, words: list, set: Optional[dict] = None, results: tuple = (0,)) -> str:
    """Standard output of a command on a scene (None: none). RuntimeError with its message if it ends with another
    code than those of a result."""
    by_hand = isinstance(scene, dict)
    line = [os.environ.get("CLOTHSIM", "clothsim"), command]
    line += [] if scene is None else ["-" if by_hand else str(scene)]
    line += [str(word) for word in words] + ["--quiet"]
    for path, value in (set or {}).items():
        line += ["--set", f"{path}={_text(value)}"]
    done = subprocess.run(line, input=json.dumps(scene) if by_hand else None,
                          stdin=None if by_hand else subprocess.DEVNULL, capture_output=True, encoding="utf-8",
                          check=False)
    if done.returncode not in results:
        raise RuntimeError(done.stderr.strip() or f"clothsim ended with {done.returncode}")
    return done.stdout


def _table(rows: list):
    try:
        import pandas  # pylint: disable=import-outside-toplevel
    except ImportError:
        return rows
    return pandas.DataFrame(rows)


def _methods(methods) -> list:
    """Options for a list of "NAME:key=value,..."; None: those that the command takes by itself."""
    return [word for method in methods or [] for word in ("--integrators", method)]


def compare(scene, methods: Optional[list] = None, set: Optional[dict] = None, seconds: float = 0.5, folder=None,
            options: tuple = ()):
    """Compares methods on a scene: a table with a row for each step or tolerance, and the columns of compare.csv, with
    nan for an empty number. `methods` are "NAME:key=value,..." (None: all); `options` are further words of
    clothsim-compare(1). Files stay in `folder` if one is named, and a second call goes on there. RuntimeError."""
    with tempfile.TemporaryDirectory() as temporary:
        into = Path(folder or temporary)
        words = ["--integrators", ",".join(methods)] if methods else []
        _call("compare", scene, [*words, "--time", seconds, "--out", into, *options], set)
        columns = load_compare(into)
    return _table([dict(zip(columns, (value.item() for value in row))) for row in zip(*columns.values())])


def advise(scene, methods: Optional[list] = None, set: Optional[dict] = None, seconds: float = 10,
           options: tuple = ()):
    """The largest safe step of each method: a table with the keys of `rows` in advise.json, None for no limit. A
    method without an answer is a row of kind "refused" with its reason in `message`. RuntimeError."""
    words = [*_methods(methods), "--time", seconds, "--json", "-", *options]
    return _table(json.loads(_call("advise", scene, words, set, (0, 8)))["rows"])


def stability(scene, method: Optional[str] = None, set: Optional[dict] = None, seconds: float = 0.5,
              options: tuple = ()):
    """Stable and unstable steps of a method (None: the scene's own): a table with a row for each cell of the map, of
    its CSV file; `options` as ("--columns", 4, "--stiffness", "10..1000"). RuntimeError."""
    with tempfile.TemporaryDirectory() as into:
        words = [*_methods([method] if method else None), "--time", seconds, "--out", into, *options]
        _call("stability", scene, words, set)
        (path,) = (path for path in Path(into).glob("*.csv") if not path.stem.endswith("_border"))
        with open(path, newline="", encoding="utf-8") as file:
            return _table([{name: field if name == "verdict" else float(field or "nan")
                            for name, field in row.items()} for row in csv.DictReader(file)])


def conform(method: str, only: Optional[list] = None, options: tuple = ()):
    """Claims of a method or a module file: a table with a row for each check, its verdict, figure and bound. A failed
    claim is a row too. RuntimeError if the method cannot be tested."""
    words = [method, "--json", "-", *(["--only", ",".join(only)] if only else []), *options]
    return _table([{"integrator": card["integrator"], **check}
                   for card in json.loads(_call("conform", None, words, None, (0, 1))) for check in card["checks"]])


@dataclass
class Picture:
    """A frame that a notebook shows."""
    png: bytes

    def _repr_png_(self) -> bytes:
        return self.png


def picture(scene, frame: int = 0, set: Optional[dict] = None, integrator: Optional[str] = None) -> Picture:
    """Draws one frame of a scene, as set by its `render` ({"render.size": [640, 480]}). RuntimeError."""
    with tempfile.TemporaryDirectory() as into:
        words = ["--frames", frame, "--every", max(frame, 1), "--overwrite", "--out", into]
        _call("run", scene, words + (["--integrator", integrator] if integrator else []), set)
        return Picture(sorted(Path(into).glob("*.png"))[-1].read_bytes())


def _amplitudes(run: Run, particle: int) -> tuple:
    """Frequencies in Hz and amplitudes in m of a particle, four times as dense as the samples give by themselves. The
    window of Hann lets a vibration leak into its neighbours alone (Harris 1978); its mean of 1/2 is divided out."""
    x = run.x[:, particle] - run.x[:, particle].mean(axis=0)
    window = np.hanning(len(x))
    lines = np.fft.rfft(x * window[:, None], 4 * len(x), axis=0)
    return (np.fft.rfftfreq(4 * len(x), run.times[1] - run.times[0]),
            2 / window.sum() * np.sqrt((np.abs(lines) ** 2).sum(axis=1)))


def spectrum(run: Run, particle: int):
    """Spectrum of a particle's motion about its mean place: a table with "frequency in Hz" and "amplitude in m"."""
    return _table([{"frequency in Hz": f, "amplitude in m": a}
                   for f, a in zip(*(row.tolist() for row in _amplitudes(run, particle)))])


def frequencies(run: Run, particle: int, most: int = 3, share: float = 0.04) -> list:
    """The lowest frequencies in Hz at which a particle moves: peaks of its spectrum above `share` of the highest one
    (the window has side lobes of 0.027), each at the vertex of the parabola through three logarithms; two periods of it
    are in the run."""
    f, amplitude = _amplitudes(run, particle)
    with np.errstate(divide="ignore"):
        log = np.log(amplitude)
    found = []
    for k in range(1, len(f) - 1):
        if f[k] * (run.times[-1] - run.times[0]) >= 2 and amplitude[k] > share * amplitude.max() and \
           log[k - 1] < log[k] >= log[k + 1]:
            found.append(float(f[k] + (f[1] - f[0]) * (log[k - 1] - log[k + 1]) /
                               (2 * (log[k - 1] - 2 * log[k] + log[k + 1]))))
    return found[:most]


def force_length(scene, stretches, set: Optional[dict] = None):
    """Force over length of the first body, a free cloth: a table with "length over rest", along x, and "force
    in N", which pulls the ends together and is negative where it pushes them apart. The width stays as it is,
    nothing moves, and gravity is off. RuntimeError."""
    rows = []
    for stretch in map(float, stretches):
        with tempfile.TemporaryDirectory() as into:
            values = {**(set or {}), "bodies[0].cloth.stretch": [stretch, 1], "forces.gravity": [0, 0, 0]}
            _call("run", scene, ["--frames", 0, "--no-render", "--export", "npz", "--export-values", "force",
                                 "--overwrite", "--out", into], values)
            with np.load(Path(into) / "run.npz") as samples:
                x, force = samples["positions"][0, :, 0], samples["forces"][0, :, 0]
                last = samples["body_offsets"][1]
        half = force[:last][x[:last] < x[:last].mean()]
        rows.append({"length over rest": stretch, "force in N": float(half.sum())})
    return _table(rows)


def plot(table, options: tuple = ()) -> Picture:
    """Draws a table of numbers over its first column by clothsim-plot(1); `options` as ("--log", "y"). RuntimeError."""
    rows = table if isinstance(table, list) else table.to_dict("records")
    with tempfile.TemporaryDirectory() as into:
        path = Path(into) / "table.csv"
        with open(path, "w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)
        _call("plot", path, ["--format", "png", "--title", " over ".join(list(rows[0])[1::-1]), *options])
        return Picture(path.with_suffix(".png").read_bytes())
