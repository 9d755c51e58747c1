#!/usr/bin/python3
"""Every command against closed streams, kinds of targets, signals and kills (as TAP).

usage: edges.py PROGRAM STEP     every STEP-th cell of the matrix; 1: all of them

Commands and options come from the program's own help: a new command needs a line in LINES, and
a new option with a FILE or a DIR is an output unless INPUTS has it. In each cell no input is
harmed, no device, FIFO or link's target is replaced, nothing hangs, and the next run of the same
command leaves no half-written file.
"""
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
import time
from pathlib import Path

program = str(Path(sys.argv[1]).resolve())
step = int(sys.argv[2])
LIMIT = 120  # s of a cell, which is taken for a hang

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
    "advise": "s.json -t 500 -q",
}
SIGNALS = [signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGXCPU, signal.SIGUSR1]
RESULT_NAMES = {"film": "target.png"}

n, failed = 0, 0


def told(name, wrong):
    global n, failed
    n += 1
    failed += bool(wrong)
    print(f"{'not ok' if wrong else 'ok'} {n} - {name}")
    for text in wrong:
        print("#   " + text.replace("\n", "\n#   "))


def run(words, **how):
    """Exit code and standard error; a process that hangs is ended, and its code is None."""
    process = subprocess.Popen([program, *words], stdout=how.pop("stdout", subprocess.DEVNULL),
                               stderr=subprocess.PIPE, **how)
    try:
        said = process.communicate(timeout=LIMIT)[1]
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        return None, "it hangs"
    return process.returncode, said.decode(errors="replace")


def tree():
    """The bytes of all that is given, and the kind of what is no file."""
    found = {}
    for path in ["s.json", "m.obj", "s.csv.part", "victim", *Path("made").iterdir(), *Path("g").iterdir()]:
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


def closed_cells(command, usual):
    for streams in itertools.chain(*(itertools.combinations(range(3), k) for k in (1, 2, 3))):
        def cell(streams=streams):
            shown = "".join(str(k) for k in streams)
            script = 'exec "$0" "$@" ' + " ".join(
                {0: "<&-", 1: ">&-", 2: "2>&-"}[k] for k in streams)
            try:
                code = subprocess.run(["sh", "-c", script, program, command,
                                       *LINES[command].split()], stdin=subprocess.DEVNULL,
                                      stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                      timeout=LIMIT, check=False).returncode
            except subprocess.TimeoutExpired:
                code = None
            # what cannot be printed is an error
            allowed = {usual, 4} if 1 in streams else {usual}
            return f"{command}, closed {shown}", code, allowed, ""
        yield cell


def make_device(path):
    try:
        os.mknod(path, 0o666 | stat.S_IFCHR, os.makedev(1, 3))
        with open(path, "w", encoding="ascii") as file:
            file.write("x")
    except OSError:
        Path(path).unlink(missing_ok=True)
        os.symlink("/dev/null", path)  # where none may be made; a link to one is kept as well


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


def target_cells(command, usual):
    for option, metavar in outputs(command):
        for kind, codes in (FILE_KINDS if metavar == "FILE" else DIR_KINDS).items():
            def cell(option=option, kind=kind, codes=codes, metavar=metavar):
                path = RESULT_NAMES.get(command, "target.csv")
                words = [command, *re.sub(f" -{option[0]} \\S+$", "", LINES[command]).split()]
                if kind == "scene":
                    path = "s.json"
                elif kind == "scene part":
                    path = "s.csv"
                    words = [word.replace("s.json", "s.csv.part") for word in words]
                else:
                    make_target(kind, path)
                if (command, option) == ("stability", "json"):
                    return None  # of --extreme alone
                if kind.startswith("scene") and "s.json" not in LINES[command]:
                    return None
                if (command, option) == ("advise", "out"):
                    words += ["--error", "1e-3"]
                reader = None
                if kind == "fifo" and metavar == "FILE":
                    reader = os.open(path, os.O_RDWR | os.O_NONBLOCK)
                before = os.lstat(path) if os.path.lexists(path) else None
                code, said = run([*words, f"--{option}", path])
                if reader is not None:
                    os.close(reader)
                after = os.lstat(path) if os.path.lexists(path) else None
                if kind in ("fifo", "device", "socket") and before and (
                        not after or after.st_ino != before.st_ino):
                    said += f"\nthe {kind} is replaced"
                    code = None
                # a job that is refused for another reason may tell that first
                allowed = {usual} if usual else set()
                allowed |= {usual if code_ == 0 else code_ for code_ in codes}
                return f"{command} --{option}, {kind}", code, allowed, said
            yield cell


def signal_cells(command, _usual):
    for number in SIGNALS if command in LONG else ():
        def cell(number=number):
            process = subprocess.Popen([program, command, *LONG[command].split()],
                                       stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
            time.sleep(random.uniform(0.1, 0.6))
            process.send_signal(number)
            try:
                said = process.communicate(timeout=LIMIT)[1].decode(errors="replace")
                code = process.returncode
            except subprocess.TimeoutExpired:
                process.kill()
                process.communicate()
                code, said = None, "it hangs"
            # a table that is there is signed, unless the signal came before it was caught
            if code and code > 0 and Path("long").is_dir() and list(Path("long").glob("*.csv")):
                verified, text = run(["verify", "long", "-q"])
                if verified:
                    code, said = None, said + text
            return f"{command}, {number.name}", code, {128 + number, -number}, said
        yield cell


def kill_cells(command, usual):
    writes = outputs(command) and shutil.which("strace")
    for k in range(1, 13) if writes else ():
        def cell(k=k):
            words = [program, command, *LINES[command].split()]
            subprocess.run(["strace", "-f", "-qq", "-o", "/dev/null", "-e", "trace=rename",
                            "-e", f"inject=rename:signal=SIGKILL:when={k}", *words],
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
            code, said = run(words[1:])
            left = [str(path) for path in Path(".").rglob("*.tmp.*")]
            if left:
                code, said = None, f"left: {left}"
            return f"{command}, killed at rename {k}", code, {usual}, said
        yield cell


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
    with tempfile.TemporaryDirectory() as work:
        os.chdir(work)
        os.mkdir("given")
        os.chdir("given")
        prepare()
        cells, usual = [], {}
        for command in commands():
            if command not in LINES:
                told(f"{command} has a line here", ["add one to LINES"])
                continue
            shutil.copytree(work + "/given", work + "/usual", symlinks=True)
            os.chdir(work + "/usual")
            usual[command], said = run([command, *LINES[command].split()])
            os.chdir(work)
            shutil.rmtree(work + "/usual")
            if usual[command] is None or usual[command] < 0 or usual[command] >= 5:
                told(f"{command} as usual", [f"{usual[command]}: {said}"])
            for make in closed_cells, target_cells, signal_cells, kill_cells:
                cells += make(command, usual[command])
        for cell in cells[::step]:
            shutil.copytree(work + "/given", work + "/cell", symlinks=True)
            os.chdir(work + "/cell")
            given = tree()
            result = cell()
            if result:
                name, code, allowed, said = result
                wrong = [] if code in allowed else [
                    f"exit code {code}, expected one of {sorted(allowed)}: {said}"]
                try:
                    wrong += [f"{path} is harmed" for path, bytes_ in given.items()
                              if Path(path).read_bytes() != bytes_]
                except OSError as error:
                    wrong.append(f"an input is gone: {error}")
                told(name, wrong)
            os.chdir(work)
            shutil.rmtree(work + "/cell")
    print(f"1..{n}")
    sys.exit(failed > 0)


main()
