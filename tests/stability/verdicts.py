#!/usr/bin/python3
"""verdicts.py PROGRAM SCENES [--part TEXT] [--every N] [--frames N] [--cpu SECONDS] [--out FILE]
One verdict over pairs of scene and method, by four commands.

Each pair is run at the default step for so many frames, plainly and with a ledger from its start.
compare runs the same cell; stability one cell of the step h that the run took, beside a run at
that h; advise names a step, which is then run with a ledger. Counted are
  contradiction  two commands, one of which says unstable and the other sound, of the same step and
                 time; advise contradicts by naming an unstable step
  dissipating    called unstable, although energy less what came in never rose
  unconfirmed    called unstable, where the ledger does not show it
  missed         called bounded by run and by the command, unstable by the ledger
stability and advise start 1e-4 of a spring's length from the scene's start and follow 200 periods
at least, so that they also find what grows later or from nothing: "only shaken", no contradiction.
compare switches corrections after steps off: where a scene has such, its cell is of another scene.
Exit status 1 unless the first three are 0. A command that takes more than so many seconds of
processor time is left out, and counted as that."""
import argparse
import csv
import json
import os
import re
import resource
import subprocess
import sys
import tempfile

GAINS = ("drag", "wind", "friction", "events_force", "pins", "parameters", "strain_limit", "events")
UNSTABLE = ("global instability", "local instability", "not finite", "blew up")


def made_and_bound(path):
    """J that the integrator made at most, and that over the energy there was, by the ledger alone."""
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


class Pair:
    """Answers of the commands about one scene and method; None: left out."""

    def __init__(self, options, scene, method, is_adaptive, folder):
        self.options, self.scene, self.method, self.folder = options, scene, method, folder
        self.is_adaptive = is_adaptive
        self.left_out, self.plain = [], None

    def call(self, name, *arguments):
        """Standard output of a command; None: it failed, or took too long."""
        limit = lambda: resource.setrlimit(resource.RLIMIT_CPU, 2 * (10 * self.options.cpu,))
        done = subprocess.run([self.options.program, name, self.scene, *arguments, "-q"],
                              capture_output=True, text=True, preexec_fn=limit)
        if done.returncode and name not in self.left_out:
            self.left_out.append(name)
        return None if done.returncode else done.stdout

    def path(self, name):
        return os.path.join(self.folder, name)

    def run(self, method, ledger, frames=0):
        report, rows = self.path("run.json"), self.path("ledger.csv")
        asked = ["-i", method, "--no-render", "-y", "-n",
                 str(frames or self.options.frames), "--json", report]
        if self.call("run", *asked, *(["--ledger", rows] if ledger else [])) is None:
            return None
        run = json.load(open(report))
        blown = run["outcome"].startswith("blew up")
        run["word"] = "blew up" if blown else run["verdict"]
        if run["outcome"] not in ("finished", "running") and not blown:
            run["word"] = run["outcome"]
        if ledger:
            run["made"], run["over"] = made_and_bound(rows)
        return run

    def stability(self, dt, seconds):
        folder = self.path("map")
        name = self.method.split(":")[0]
        # the axis stands still at the scene's own value
        body = self.plain["scene"]["bodies"][0]["springs"]
        k = repr(max(body["stretch"], body["shear"], body["bend"]))
        if self.call("stability", "-i", f"{name}:dt={dt!r}", "--columns", "1", "--rows", "1",
                     "--stiffness", f"{k}..{k}", "--dt", f"{dt!r}..{dt!r}", "-t", repr(seconds),
                     "--budget", str(self.options.cpu / 4), "-j", "1", "-y", "-o", folder) is None:
            return None
        files = [f for f in os.listdir(folder) if f.endswith(".csv") and "_border" not in f]
        return next(csv.DictReader(open(os.path.join(folder, files[0]))))

    def compare(self, seconds):
        folder = self.path("compare")
        if self.call("compare", "-i", self.plain["method"], "-t", repr(seconds), "--runs", "1",
                     "--reference", "velocity-verlet", "--reference", "implicit-linearised",
                     "--budget", str(self.options.cpu / 4), "-y", "-o", folder) is None:
            return None
        return next(csv.DictReader(open(os.path.join(folder, "compare.csv"))))

    def advise(self, seconds):
        out = self.call("advise", "-i", self.method, "-t", repr(seconds),
                        "--budget", str(self.options.cpu / 4), "-j", "1")
        if out is None:
            return None
        lines = out.splitlines()
        at = next(k for k, line in enumerate(lines) if line.startswith("method"))
        numbers = lines[at + 1].split()[1:3]
        dt = None if numbers[1] == "-" else float(numbers[1])
        return {"dt": dt, "why": lines[at + 2].strip()}

    def default_step(self):
        """h of the plain run in s; None: the method chooses its steps."""
        run = self.plain
        asked = re.search(r"[:,]dt=([^,]+)", run["method"])
        if self.is_adaptive or not asked:
            return None
        if float(asked.group(1)) > 0:
            return float(asked.group(1))
        if any("dt automatic" in note for note in run["notes"]):
            return run["time"] / max(run["counts"]["steps"], 1)
        return 1 / run["scene"]["time"]["fps"]


def is_unstable(word):
    return any(word.startswith(u) for u in UNSTABLE)


def contradicts(a, b):
    """True if of two words one is an instability and the other is sound."""
    sound = ("bounded", "over-damped")
    return (is_unstable(a) and b in sound) or (is_unstable(b) and a in sound)


def fault_of(plain):
    """What it is that a ledger alone shows, where a plain run says so."""
    return "missed" if plain == "bounded" else "contradiction"


def judge_by_ledger(name, word, run, found):
    """A word of a command against the ledger of a run of that step."""
    if not is_unstable(word) or "blew up" in word or "not finite" in word:
        return
    if not run["made"] > 0:
        found.append(f"dissipating: {name}")
    elif "global" in word and not run["over"] > 1:
        found.append(f"unconfirmed: {name}")


def judge_stability(pair, row, found):
    h = pair.default_step()
    seconds = pair.plain["time"]
    cell = pair.stability(h, seconds)
    fps = pair.plain["scene"]["time"]["fps"]
    frames = int(float(cell["time"]) * fps) + 1 if cell and is_unstable(cell["verdict"]) else 0
    twin = cell and pair.run(f"{pair.method}:dt={h!r}", True, max(frames, pair.options.frames))
    if not twin:
        return
    row["stability"], row["run at h"] = cell["verdict"], twin["word"]
    if is_unstable(cell["verdict"]) and not is_unstable(twin["word"]):
        found.append("only shaken: stability")
    elif contradicts(cell["verdict"], twin["word"]):
        plain = pair.run(f"{pair.method}:dt={h!r}", False)
        found.append(fault_of(plain["word"]) + ": stability")
    else:
        judge_by_ledger("stability", cell["verdict"], twin, found)


def judge_compare(pair, row, full, found):
    cell = pair.compare(pair.plain["time"])
    if not cell or cell["outcome"] in ("over budget", "refused"):
        return
    word = next((u for u in UNSTABLE if u in cell["note"]), "bounded")
    row["compare"] = word = "blew up" if cell["outcome"].startswith("blew up") else word
    if cell["state_hash"] != pair.plain["state_hash"]:
        row["compare"] += ", of another scene"
    elif contradicts(word, pair.plain["word"]) or contradicts(word, full["word"]):
        found.append(fault_of(pair.plain["word"] if word == "bounded" else word) + ": compare")
    else:
        judge_by_ledger("compare", word, full, found)


def judge_advise(pair, row, full, found):
    advice = pair.advise(pair.plain["time"])
    if not advice:
        return
    row["advise"] = advice["why"]
    if not advice["dt"]:
        return
    row["advised"], h = advice["dt"], pair.default_step()
    if h and advice["dt"] >= 0.999 * h:
        if is_unstable(full["word"]):
            found.append(fault_of(pair.plain["word"]) + ": advise")
        return
    run = pair.run(f"{pair.method}:dt={advice['dt']!r}", True)
    if run and is_unstable(run["word"]):
        plain = pair.run(f"{pair.method}:dt={advice['dt']!r}", False)
        found.append(fault_of(plain["word"]) + ": advise")


def work_of(run):
    """Work of a run in s at 5e7 springs a second, on any machine; a particle counts as ten."""
    counts = run["counts"]
    passes = sum(counts[key] for key in ("forces", "jvps", "solve_iterations", "sweeps", "steps"))
    return passes * (1e-6 + 2e-8 * (run["springs"] + 10 * run["particles"]))


def judge(options, scene, method, is_adaptive):
    """One pair: a row of words, with what was found."""
    with tempfile.TemporaryDirectory() as folder:
        pair = Pair(options, scene, method, is_adaptive, folder)
        row, found = {"scene": os.path.relpath(scene, options.scenes), "method": method}, []
        pair.plain = pair.run(method, False)
        # the others take many times as long
        full = pair.plain and work_of(pair.plain) < options.cpu / 8 and pair.run(method, True)
        if full:
            row["run"], row["run --ledger"] = pair.plain["word"], full["word"]
            row["made"], row["over"] = full["made"], full["over"]
            if contradicts(pair.plain["word"], full["word"]):
                found.append("missed: run" if is_unstable(full["word"]) else "contradiction: run")
            judge_by_ledger("run", pair.plain["word"], full, found)
            judge_by_ledger("run --ledger", full["word"], full, found)
            judge_compare(pair, row, full, found)
            judge_advise(pair, row, full, found)
            if pair.default_step():
                judge_stability(pair, row, found)
        row["left out"], row["found"] = pair.left_out, found
        return row


def pairs_of(options):
    """Pairs, every N-th of the table of all, so that all scenes and methods take part."""
    listed = subprocess.run([options.program, "integrators"], capture_output=True, text=True, check=True)
    methods = re.findall(r"^([a-z]\S*) *(.*)", listed.stdout, re.M)
    scenes = [os.path.join(at, f) for at, _, files in sorted(os.walk(options.scenes))
              for f in sorted(files) if f.endswith(".json") and options.without not in at and "extreme" not in at]
    for i, scene in enumerate(scenes):
        for j, (method, traits) in enumerate(methods):
            if (i + j) % options.every == 0 and re.search(options.part, f"{scene} {method}"):
                yield scene, method, "adaptive" in traits


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("program", type=os.path.abspath)
    parser.add_argument("scenes", type=os.path.abspath)
    parser.add_argument("--part", default="")
    parser.add_argument("--without", default="extreme")
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--frames", type=int, default=12)
    parser.add_argument("--cpu", type=int, default=20)
    parser.add_argument("--out", default=os.devnull)
    options = parser.parse_args()
    kinds = ("contradiction", "dissipating", "unconfirmed", "missed", "only shaken")
    count = dict.fromkeys(("pairs", "by all commands", "left out", "unstable") + kinds, 0)
    with open(options.out, "a") as out:
        for scene, method, is_adaptive in pairs_of(options):
            row = judge(options, scene, method, is_adaptive)
            print(json.dumps(row), file=out, flush=True)
            count["pairs" if "run" in row else "left out"] += 1
            if "run" in row:
                count["by all commands"] += not row["left out"]
                count["unstable"] += is_unstable(row["run --ledger"])
            for kind in kinds:
                count[kind] += sum(f.startswith(kind) for f in row["found"])
            if row["found"]:
                print(json.dumps(row), flush=True)
    print(count)
    return any(count[k] for k in kinds[:3])


sys.exit(main())
