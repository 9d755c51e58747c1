#!/usr/bin/python3
"""Every command against closed streams, kinds of targets, and signals at each call (as TAP).

usage: edges.py PROGRAM STEP     every STEP-th cell of the matrix; 1: all of them

Commands and options come from the program's own help: a new command needs a line in LINES, and
a new option with a FILE or a DIR is an output unless INPUTS has it. In each cell no input is
harmed, no device, FIFO or link's target is replaced, nothing hangs, what is signed verifies, and
the next run of the same command leaves no half-written file.
"""
import collections
import functools
import itertools
import json
import os
import random
import re
import shutil
import signal
import socket
import stat
import subprocess
import sys
import tempfile
import threading
import time
import tty
from pathlib import Path

sys.argv[1:] or sys.exit("usage: edges.py PROGRAM STEP")

program = str(Path(sys.argv[1]).resolve())
step = int(sys.argv[2])
LIMIT = 1100  # s of a cell, which is taken for a hang: just below the limit of the whole test

SCENE = {"bodies": [{"cloth": {"grid": [3, 3]}, "mass": {"total": 0.1}, "pins": ["top-left"],
                     "springs": {"stretch": 50}}], "render": {"size": [16, 16]}}
# a small job of each command; made/ is a run, cmp/ a comparison, g/ has golden files
LINES = {
    "run": "s.json -n 2 --renderer cpu -q -y",
    "integrators": "rk4",
    "scene": "s.json",
    "new": "integrator heun -y",
    "golden": "--folder g --hashes -q",
    "conform": "rk4 --only abi,options -q",
    "compare": "s.json -t 0.02 -i rk4:dt=2e-3 --runs 1 -q -y",
    "sweep": "s.json -i rk4:dt=2e-3 -n 1 -s bodies[0].springs.stretch=50,60 -q -y",
    "merge": "cmp -q -y",
    "mesh": "m.obj -y",
    "reproduce": "made/run.json -q",
    "bisect": "s.json -n 1 -b threads=1 -q",
    "verify": "made",
    "film": "made --sheet 1x1 -q -y -o sheet.png",
    "plot": "cmp/compare.csv -q -o cmp/plot",
    "stability": "s.json -i rk4 --columns 1 --rows 2 -t 0.02 -q -y",
    "advise": "s.json -i velocity-verlet -t 0.05 -q",  # --out is only for --error, below
    "soft-bench": "s.json -q -y",  # refused: a measurement takes minutes
}
INPUTS = {"plugin", "resume", "folder", "cache"}
# jobs that go on until they are told to stop, of the commands that have such
LONG = {
    "run": "s.json -n 10000000 --no-render -q -y -o long --checkpoint 1",
    "conform": "rk4 -q",
    "compare": "s.json -t 100 -i rk4:dt=1e-6 --runs 1 -q -y -o long",
    "sweep": "s.json -i rk4:dt=1e-6 -n 6000 -s bodies[0].springs.stretch=50,60 -q -y -o long",
    "stability": "s.json -i rk4 --columns 9 --rows 9 -t 50 -q -y -o long",
    "advise": "s.json -t 500 --error 1e-9 -q -o long",
    "bisect": "s.json -n 9000000 -b threads=1 -q",
    "golden": "--folder g --add s.json -n 9000000 -i rk4 -q",
}
SIGNALS = [signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGXCPU, signal.SIGUSR1]
ENDS = [signal.SIGKILL, *SIGNALS]
# those that draw diagrams or run for long: a kill and SIGTERM at each call, all signals at renames
LONG_CELLS = {"compare", "stability", "advise"}
RESULT_NAMES = {"film": "target.png"}

n, failed = 0, 0


def told(name, wrong):
    global n, failed
    n += 1
    failed += bool(wrong)
    print(f"{'not ok' if wrong else 'ok'} {n} - {name}")
    for text in wrong:
        print("#   " + text.replace("\n", "\n#   "))


def closing(streams, words):
    """The words of a command with closed streams."""
    ends = " ".join({0: "<&-", 1: ">&-", 2: "2>&-"}[k] for k in streams)
    return ["sh", "-c", 'exec "$0" "$@" ' + ends, *words] if streams else words


def ended(process):
    """Exit code and standard error; a process that hangs is ended, and its code is None."""
    try:
        said = process.communicate(timeout=LIMIT)[1]
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        return None, "it hangs"
    return process.returncode, said.decode(errors="replace")


def run(words, streams=(), before=()):
    return ended(subprocess.Popen([*before, *closing(streams, [program, *words])],
                                  stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                  stderr=subprocess.PIPE))


def tree():
    """The bytes of all that is given, and the kind of what is no file."""
    found = {}
    stored = [path for path in Path("g").rglob("*") if path.is_file()]
    for path in ["s.json", "m.obj", "s.csv.part", "victim", *Path("made").iterdir(), *stored]:
        found[str(path)] = Path(path).read_bytes()
    return found


def commands():
    text = subprocess.run([program, "help"], capture_output=True, text=True, check=True).stdout
    return [name for name in re.findall(r"^  ([a-z-]+) +\S", text, re.M) if name != "help"]


def outputs(command):
    """Options of a command that name an output, with FILE or DIR."""
    text = subprocess.run([program, "help", command], capture_output=True, text=True,
                          check=True).stdout
    found = re.findall(r"^ +(?:-\w, )?--([a-z-]+) (FILE|DIR)\b", text, re.M)
    return [(name, kind) for name, kind in found if name not in INPUTS]


@functools.cache
def own_terminal():
    """The name of a pseudo-terminal of this test alone, which reads what it is told."""
    reader, terminal = os.openpty()
    tty.setraw(terminal)
    threading.Thread(target=lambda: all(iter(lambda: os.read(reader, 65536), b"")), daemon=True).start()
    return os.ttyname(terminal)


def make_device(path):
    try:
        os.mknod(path, 0o666 | stat.S_IFCHR, os.makedev(1, 3))
        with open(path, "w", encoding="ascii") as file:
            file.write("x")
    except OSError:  # where none may be made, a link to a terminal of this test alone
        Path(path).unlink(missing_ok=True)
        os.symlink(own_terminal(), path)


def make_target(kind, path):
    """Puts what the kind is called at the path."""
    if kind == "file":
        Path(path).write_text("old", encoding="ascii")
    elif kind == "link":
        os.symlink("victim", path)
    elif kind == "dangling":
        os.symlink("nowhere", path)
    elif kind == "fifo":
        os.mkfifo(path)
    elif kind == "device":
        make_device(path)
    elif kind == "folder":
        os.mkdir(path)
    elif kind == "socket":
        socket.socket(socket.AF_UNIX).bind(path)
    elif kind == "part link":
        os.symlink("victim", path + ".part")
    elif kind == "part file":
        os.link("victim", path + ".part")


# whether an output is written there (0), refused (4), or either, as not every output has a part
FILE_KINDS = {"new": {0}, "file": {0}, "link": {0}, "dangling": {0}, "fifo": {0, 4},
              "device": {0, 4}, "folder": {4}, "socket": {4}, "part link": {0, 4},
              "part file": {0, 4}, "scene": {4}, "scene part": {0, 4}}
DIR_KINDS = {"new": {0}, "folder": {0}, "file": {4}, "fifo": {4}, "device": {4}, "socket": {4}}


STREAMS = [()] + [c for k in (1, 2, 3) for c in itertools.combinations(range(3), k)]
# calls that change files, at each of which a signal may come
CALLS = ["rename", "write", "fsync", "ftruncate", "flock", "mkdir", "unlink"]


class Cell:
    """One job: a command, an output and what is there, closed streams, a signal at a call."""
    def __init__(self, command, usual, target=None, streams=(), event=None):
        self.command, self.usual, self.target = command, usual, target
        self.streams, self.event = streams, event
        self.name = command + (f" --{target[0]}, {target[2]}" if target else "")
        self.name += ", closed " + "".join(map(str, streams)) if streams else ""
        if event:
            self.name += f", {event[0].name} at {event[1]} {event[2]}"

    def words(self):
        """Puts the target there; the words of the command line, and the codes it may end with."""
        line = LINES[self.command]
        if not self.target:
            return [self.command, *line.split()], {self.usual}
        option, metavar, kind = self.target
        path = RESULT_NAMES.get(self.command, "target.csv")
        words = [self.command, *re.sub(f" -{option[0]} \\S+$", "", line).split()]
        if kind == "scene":
            path = "s.json"
        elif kind == "scene part":
            path = "s.csv"
            words = [word.replace("s.json", "s.csv.part") for word in words]
        else:
            make_target(kind, path)
        if (self.command, option) == ("advise", "out"):
            words += ["--error", "1e-3"]
        codes = (FILE_KINDS if metavar == "FILE" else DIR_KINDS)[kind]
        # a job that is refused for another reason may tell that first
        allowed = {self.usual} if self.usual else set()
        allowed |= {self.usual if code == 0 else code for code in codes}
        return [*words, f"--{option}", path], allowed

    def interrupted(self, words):
        """Sends the signal; what is wrong then."""
        number, call, k = self.event
        code, said = run(words, before=["strace", "-f", "-qq", "--seccomp-bpf", "-o", "/dev/null",
                                        "-e", f"trace={call}", "-e",
                                        f"inject={call}:signal={number.name}:when={k}"])
        if code is None:
            return [said]
        # a table that is there is signed, unless the signal came before it was caught
        for manifest in Path(".").glob("*/manifest.txt"):
            verified, text = run(["verify", str(manifest.parent), "-q"])
            if verified:
                return [f"{manifest.parent}: {text}"]
        return []

    def try_(self):
        words, allowed = self.words()
        path, kind, wrong, reader = words[-1], self.target and self.target[2], [], None
        if kind == "fifo" and self.target[1] == "FILE":
            reader = os.open(path, os.O_RDWR | os.O_NONBLOCK)
        before = os.lstat(path) if kind and os.path.lexists(path) else None
        if self.event:
            wrong += self.interrupted(words)
        if 1 in self.streams:
            allowed = allowed | {4}  # what cannot be printed is an error
        code, said = run(words, streams=self.streams)
        if reader is not None:
            os.close(reader)
        if code not in allowed:
            wrong.append(f"exit code {code}, expected one of {sorted(allowed)}: {said}")
        after = os.lstat(path) if kind and os.path.lexists(path) else None
        if kind in ("fifo", "device", "socket") and (not after or after.st_ino != before.st_ino):
            wrong.append(f"the {kind} is replaced")
        left = [str(path) for path in Path(".").rglob("*") if re.search(
            r"[.]tmp[.]|[.]part$", path.name) and path.name != "s.csv.part"]
        if left and not (kind or "").startswith("part") and code not in (3, 4):
            wrong.append(f"left: {left}")
        return wrong


class Signalled:
    """A job that goes on until it is told to stop, and is."""
    def __init__(self, command, number, streams, after):
        self.command, self.number, self.streams, self.after = command, number, streams, after
        self.name = f"{command}, closed {streams}, {number.name} after {after:.2f} s"

    def try_(self):
        process = subprocess.Popen(closing(self.streams, [program, self.command,
                                                          *LONG[self.command].split()]),
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        time.sleep(self.after)
        over = process.poll() == 0  # before the signal came: it shows nothing
        process.send_signal(self.number)
        code, said = ended(process)
        wrong = [] if over or code in (128 + self.number, -self.number) else [f"exit code {code}: {said}"]
        if code and code > 0 and list(Path(".").glob("long/*.csv")):
            verified, text = run(["verify", "long", "-q"])
            wrong += [text] if verified else []
        return wrong


def targets(command):
    """Outputs of a command, and what may stand there."""
    for option, metavar in outputs(command):
        for kind in FILE_KINDS if metavar == "FILE" else DIR_KINDS:
            alone = (command, option) == ("stability", "json")  # of --extreme alone
            if not alone and (not kind.startswith("scene") or "s.json" in LINES[command]):
                yield option, metavar, kind


def cells_of(command, usual, calls):
    """The matrix of a command that makes so many calls of each kind."""
    for streams in STREAMS:
        yield Cell(command, usual, None, streams)
        for number in SIGNALS if command in LONG else ():
            yield Signalled(command, number, streams, random.uniform(0.05, 0.5))
    for target in targets(command):
        for streams in STREAMS:
            yield Cell(command, usual, target, streams)
        # one file more than usual has a rename of its own
        for k in range(1, calls["rename"] + 2) if target[1] == "FILE" else ():
            for number in ENDS[:2] if command in LONG_CELLS else ENDS:
                yield Cell(command, usual, target, (), (number, "rename", k))
    for call, most in calls.items():
        few = command in LONG_CELLS and call != "rename"
        for k in range(1, most + 1):
            for number in ENDS[:2] if few else ENDS:
                yield Cell(command, usual, None, (), (number, call, k))


def count_calls(command):
    """Exit code and error of a command as usual, and its calls: the most that one process makes."""
    if not shutil.which("strace"):
        return (*run([command, *LINES[command].split()]), dict.fromkeys(CALLS, 0))
    code, said = run([command, *LINES[command].split()],
                     before=["strace", "-f", "-qq", "--seccomp-bpf", "-o", "calls", "-e",
                             "trace=" + ",".join(CALLS)])
    made = collections.Counter(re.findall(r"^(\d+) +(\w+)\(", Path("calls").read_text(), re.M))
    return code, said, {call: max([n for (_, name), n in made.items() if name == call], default=0)
                        for call in CALLS}


def prepare():
    Path("s.json").write_text(json.dumps(SCENE), encoding="ascii")
    Path("m.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", encoding="ascii")
    Path("victim").write_text("precious", encoding="ascii")
    for words in ("run s.json -n 1 --renderer cpu -q -o made",
                  "compare s.json -t 0.02 -i rk4:dt=2e-3 --runs 1 -q -o cmp",
                  "golden --folder g --add s.json -n 1 -i rk4 -q"):
        code, said = run(words.split())
        if code:
            sys.exit(f"Bail out! {words}: {code}: {said}")
    shutil.copy("s.json", "s.csv.part")


def main():
    random.seed(1)
    for number in SIGNALS:  # commands inherit what nohup and shells in the background ignore
        signal.signal(number, signal.SIG_DFL)
    with tempfile.TemporaryDirectory() as work:
        os.chdir(work)
        os.mkdir("given")
        os.chdir("given")
        prepare()
        cells = []
        for command in commands():
            if command not in LINES:
                told(f"{command} has a line here", ["add one to LINES"])
                continue
            shutil.copytree(work + "/given", work + "/usual", symlinks=True)
            os.chdir(work + "/usual")
            code, said, calls = count_calls(command)
            os.chdir(work)
            shutil.rmtree(work + "/usual")
            if code is None or code < 0 or code >= 5:
                told(f"{command} as usual", [f"{code}: {said}"])
            cells += cells_of(command, code, calls)
        for cell in cells[::step]:
            shutil.copytree(work + "/given", work + "/cell", symlinks=True)
            os.chdir(work + "/cell")
            given = tree()
            wrong = cell.try_()
            try:
                wrong += [f"{path} is harmed" for path, bytes_ in given.items()
                          if Path(path).read_bytes() != bytes_]
            except OSError as error:
                wrong.append(f"an input is gone: {error}")
            told(cell.name, wrong)
            os.chdir(work)
            shutil.rmtree(work + "/cell")
    print(f"1..{n}")
    sys.exit(failed > 0)


main()
