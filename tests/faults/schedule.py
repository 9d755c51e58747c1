#!/usr/bin/python3
"""Two processes in one folder, by interleavings that a scheduler chooses (as TAP).

usage: schedule.py PROGRAM STOPS NUMBER    so many interleavings of each pair

STOPS (stops.c) stops each process before each call that others see; one of them goes on for a
number of calls that is chosen at random, from a single one to all. An interleaving is its seed:
what it found is found again. However they meet, each process ends with 0 or is refused with 4 in
one line; what is there in the end is wholly of one of them or the union of their rows, is signed,
and has no half-written file beside it.
"""
import csv
import json
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile

sys.argv[1:] or sys.exit("usage: schedule.py PROGRAM STOPS NUMBER")

SCENE = {"bodies": [{"cloth": {"grid": [3, 3]}, "mass": {"total": 0.1}, "pins": ["top-left"],
                     "springs": {"stretch": 50}}], "render": {"size": [16, 16]}}
RUN = "run s.json -q -y --renderer cpu -i rk4:dt=2e-3 --monitor w.csv"
SWEEP = "sweep s.json -i rk4:dt=2e-3 -n 1 -s bodies[0].springs.stretch=50,60 -q -o s"
COMPARE = "compare s.json -t 0.02 -i rk4:dt=2e-3,rk4:dt=1e-3 --runs 1 -q"
CLOCK = {"cpu", "cpu_low", "cpu_high", "wall", "runs", "outliers", "check", "machine"}
MOST = 20000  # calls of a pair, beyond which it is taken for a hang

program = str(pathlib.Path(sys.argv[1]).resolve())
stops = str(pathlib.Path(sys.argv[2]).resolve())
number = int(sys.argv[3])


class Process:
    def __init__(self, folder, words, name):
        self.said = open(folder / f"../{name}", "w+b")
        self.process = subprocess.Popen([program, *words.split()], cwd=folder, stderr=self.said,
                                        stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                        env=dict(os.environ, LD_PRELOAD=stops,
                                                 ASAN_OPTIONS="verify_asan_link_order=0"))
        self.code = None
        self.wait()

    def wait(self):
        """Until it stops, or ends with a code."""
        _, status = os.waitpid(self.process.pid, os.WUNTRACED)
        if not os.WIFSTOPPED(status):
            self.code = self.process.returncode = os.waitstatus_to_exitcode(status)

    def step(self):
        os.kill(self.process.pid, signal.SIGCONT)
        self.wait()

    def error(self):
        self.said.seek(0)
        return self.said.read().decode()


def interleave(folder, lines, seed):
    """Exit codes and errors of the commands."""
    rng = random.Random(seed)
    processes = [Process(folder, line, f"said{k}") for k, line in enumerate(lines)]
    calls = 0
    while any(process.code is None for process in processes):
        process = rng.choice([process for process in processes if process.code is None])
        for _ in range(rng.choice([1, 1, 2, 5, 20, 100, MOST])):
            if process.code is not None or calls > MOST:
                break
            process.step()
            calls += 1
            # what waits for the other must not use up its turn
            if rng.random() < 0.02:
                break
        if calls > MOST:
            for one in processes:
                one.process.kill()
            return [None, None], ["they wait for each other"]
    return [process.code for process in processes], [process.error() for process in processes]


def alone(words):
    done = subprocess.run([program, *words.split()], capture_output=True, check=False)
    return done.returncode, done.stderr.decode()


def rows(path):
    with open(path, newline="", encoding="utf-8") as file:
        return sorted(tuple(sorted((k, v) for k, v in row.items() if k not in CLOCK))
                      for row in csv.DictReader(file))


def files(*names):
    return {name: pathlib.Path(name).read_bytes() for name in names if pathlib.Path(name).exists()}


class Runs:
    """Two runs of one folder and one monitor: the result is that of one of them."""
    name = "two runs, one folder and one monitor"
    lines = [f"{RUN} -n 2 -o o", f"{RUN} -n 2 -o o -s forces.drag=1"]
    folders = ["o", "o"]
    shared = ["w.csv", "o/frame_00001.png", "o/frame_00002.png"]

    def __init__(self):
        self.results = []
        for line in self.lines:
            alone(line)
            self.results.append(files(*self.shared))
        assert self.results[0] != self.results[1]

    def judge(self, codes):
        ended = [result for result, code in zip(self.results, codes) if code == 0]
        if ended and files(*self.shared) not in ended:
            return "files of neither run, or of both"
        done = [folder for folder, code in zip(self.folders, codes) if code == 0]
        return "verify differs" if any(alone(f"verify {one} -q")[0] for one in done) else ""


class Monitors(Runs):
    name = "two runs, one monitor and a folder each"
    lines = [f"{RUN} -n 2 -o o", f"{RUN} -n 2 -o p -s forces.drag=1"]
    folders = ["o", "p"]
    shared = ["w.csv"]


class Sweeps:
    """Two sweeps fill one table."""
    name = "two sweeps, one table"
    lines = [SWEEP, SWEEP]
    folder, table = "s", "s/sweep.csv"

    def __init__(self):
        alone(self.lines[0])
        self.rows = rows(self.table)

    def judge(self, codes):
        if codes != [0, 0]:
            return "one is refused"
        if rows(self.table) != self.rows:
            return f"rows {rows(self.table)}"
        return "" if alone(f"verify {self.folder} -q")[0] == 0 else "verify differs"


class Compares(Sweeps):
    name = "two comparisons, one table"
    lines = [f"{COMPARE} -o c --shard 1/2", f"{COMPARE} -o c --shard 2/2"]
    folder, table = "c", "c/compare.csv"

    def __init__(self):
        alone(f"{COMPARE} -o c --shard 1/2")
        alone(f"{COMPARE} -o c --shard 2/2")
        self.rows = rows(self.table)
        assert len(self.rows) == 2


class Merge(Compares):
    """A merge beside a comparison takes whole rows of it, and its table is whole in the end."""
    name = "merge beside compare"
    lines = [f"{COMPARE} -o c --shard 1/1", "merge c -o m -q"]

    def judge(self, codes):
        if codes[0] or codes[1] not in (0, 4):
            return "compare fails" if codes[0] else "merge fails"
        if codes[1] == 0 and not set(rows("m/compare.csv")) <= set(self.rows):
            return "merge has other rows"
        if rows(self.table) != self.rows or alone("verify c -q")[0]:
            return "the table of compare is not whole"
        again = alone("merge c -o n -q")
        return "" if again[0] == 0 and rows("n/compare.csv") == self.rows else f"again: {again}"


def try_(kind, folder, seed):
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    (folder / "s.json").write_text(json.dumps(SCENE), encoding="ascii")
    os.chdir(folder)
    codes, said = interleave(folder, kind.lines, seed)
    if not all(code in (0, 4) for code in codes):
        return f"exit codes {codes}: {said}"
    if any(code == 4 and text.count("\n") != 1 for code, text in zip(codes, said)):
        return f"refused with {said}"
    left = [str(path) for path in pathlib.Path(".").rglob("*")
            if ".tmp." in path.name or path.name.endswith(".part")]
    why = f"left {left}" if left else kind.judge(codes)
    return why and f"{why}; exit codes {codes}, {said}"


def main():
    bad = 0
    with tempfile.TemporaryDirectory() as work:
        folder = pathlib.Path(work) / "shared"
        kinds = [Runs, Monitors, Sweeps, Compares, Merge]
        for n, make in enumerate(kinds, 1):
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir()
            os.chdir(folder)
            (folder / "s.json").write_text(json.dumps(SCENE), encoding="ascii")
            kind, wrong = make(), []
            for seed in range(number):
                why = try_(kind, folder, seed)
                wrong += [f"interleaving {seed}: {why}"] if why else []
            bad += bool(wrong)
            print(f"{'not ok' if wrong else 'ok'} {n} - {kind.name}: {number} interleavings, "
                  f"{len(wrong)} wrong", flush=True)
            for text in wrong[:10]:
                print("#   " + text.replace("\n", " "))
        os.chdir("/")
    print(f"1..{len(kinds)}")
    return bad > 0


sys.exit(main())
