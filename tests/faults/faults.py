#!/usr/bin/python3
"""Fails the n-th allocation, write, rename, fsync, thread, opening, seek or removal of a file, or
reading of a module for its hash, in nineteen command lines, and holds how they end to what is
promised: an exit code of the kind and one line that says what failed, or the same output and exports
as ever (as TAP).

usage: faults.py PROGRAM SHIM POINTS [WORD]    POINTS of each kind and line, spread evenly, by turns
                                               failing once and from there on, without OpenGL; 0:
                                               all, both ways
                                               WORD: only of the lines that it is in
"""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

sys.argv[1:] or sys.exit("usage: faults.py PROGRAM SHIM POINTS [WORD]")

CLOTH = {"cloth": {"grid": [6, 5]}, "mass": {"total": 1}, "springs": {"stretch": 60},
         "pins": ["top"]}
SCENE = {"bodies": [CLOTH], "colliders": [{"sphere": {"centre": [0.5, -1.6, 0.1], "radius": 0.3}}],
         "time": {"fps": 100}, "render": {"size": [32, 24]}}
SPRINGS = {"bodies": [CLOTH], "time": {"fps": 100}}
RUN = ["run", "s.json", "-n", "2", "-q", "--no-render", "--hash", "-i"]
LINES = {
    "help": ["run", "--help"],
    "scene": ["scene", "s.json", "--plan"],
    "integrators": ["integrators"],
    "files": [*RUN, "velocity-verlet", "--states", "st", "--monitor", "w.csv", "--json", "r.json",
              "--ledger", "l.csv", "-o", "out", "--checkpoint", "1", "-y"],
    "exports": [*RUN, "velocity-verlet", "--export", "obj,pc2,vtp,npz", "--export-values",
                "force,strain", "-o", "ex", "--checkpoint", "1", "-y"],
    "archive": [*RUN, "velocity-verlet", "--export", "npz", "-o", "ar", "-y"],
    "threads": [*RUN, "implicit-linearised", "--threads", "3"],
    "sundials": [*RUN, "cvode-bdf"],
    "cholmod": ["run", "p.json", *RUN[2:], "fast-mass-spring"],
    "conform": ["conform", "--only", "pins", "velocity-verlet"],
    "cpu": ["run", "s.json", "-n", "2", "-q", "--hash", "-y", "--renderer", "cpu"],
    "sheet": ["film", "rr", "--sheet", "2x1", "-o", "sheet.png", "-y", "-q"],
    "merge": ["merge", "p1", "p2", "-o", "whole", "-y"],
    "reproduce": ["reproduce", "rr"],
    "sweep": ["sweep", "p.json", "-s", "forces.drag=0,0.1", "-i", "rk4", "-n", "1", "-o", "sw", "-y"],
    "compare": ["compare", "p.json", "-i", "rk4:dt=5e-3", "--reference", "rk4:dt=1e-3",
                "--reference", "dopri5:rtol=1e-9,atol=1e-9", "-t", "0.02", "--runs", "1", "-o", "cc",
                "-y", "-q"],
    "stability": ["stability", "p.json", "-i", "rk4", "--columns", "1", "--rows", "1", "-t", "0.02",
                  "-j", "1", "-o", "map", "-y", "-q"],
    "bisect": ["bisect", "p.json", "-n", "1", "-i", "rk4:dt=0.005", "-b", "threads=2", "-q"],
    "osmesa": ["run", "s.json", "-n", "1", "-q", "--hash", "-y", "--renderer", "osmesa"],
}
# those that find no earlier files of their own, which they would remove
FRESH = {"archive": "ar", "stability": "map"}
# what the lines above read
PREPARED = [["run", "s.json", "-n", "2", "-q", "-o", "rr", "--renderer", "cpu"],
            *(["sweep", "p.json", "-s", "forces.drag=0,0.1", "-i", "rk4", "-n", "1", "-q", "-o",
               f"p{k}", "--shard", f"{k}/2"] for k in (1, 2))]
# exit codes and what the line says, where it did not end as ever; a file that cannot be opened may
# be a scene, a module or a renderer
KINDS = {
    "memory": ({7}, r"memory|Cannot allocate|cannot start thread"),
    "write": ({4}, r"cannot write (.*(No space left|an earlier write failed)|to standard output)"),
    "rename": ({4}, r"cannot write .*Permission denied"),
    "fsync": ({4}, r"cannot write .*Input/output error"),
    "thread": ({5, 7}, r"cannot start thread .*temporarily unavailable|osmesa\" hung while it"),
    "open": ({4, 5}, r"Too many open files"),
    "lseek": ({4}, r"cannot (read|write) .*Input/output error"),
    "unlink": ({4}, r"cannot remove .*Permission denied"),
    "module": ({4}, r"cannot read .*[.]so\": Permission denied"),
}


class Fault:
    def __init__(self, program, shim):
        self.program, self.shim = program, shim

    def run(self, line, **more):
        environment = dict(os.environ, LD_PRELOAD=self.shim, LC_ALL="C", PATH="", **more)
        try:
            return subprocess.run([self.program, *line], env=environment, capture_output=True,
                                  timeout=1200)
        except subprocess.TimeoutExpired as late:
            return subprocess.CompletedProcess(line, "hang", late.stdout or b"", b"")

    def count(self, line):
        """How often each kind happens, and what is printed where nothing fails."""
        found = self.run(line, FAULT_COUNT="count")
        if found.returncode:
            sys.exit(f"without a fault: {found.stderr.decode()}")
        return {kind: int(n) for kind, n in map(str.split, open("count"))}, found


def judge(kind, found, whole, name=""):
    """What is wrong, or nothing."""
    codes, words = KINDS[kind]
    said = found.stderr.decode(errors="replace").splitlines()
    own = [text for text in said if text.startswith("clothsim: ")]
    if found.returncode == 0 and kind == "module":
        return "a result without the hash of its module, and no word of it"
    if found.returncode == 0:
        # a comparison prints times; what reproduce cannot compare is said where it says what changed
        same = found.stdout == whole.stdout or b"error below" in whole.stdout or \
            re.search(rb"cannot be read|cannot read .*Too many open files|failed: cell .*: ",
                      found.stdout)
        return "" if same else "other output, and no word of it"
    if found.returncode not in codes:
        return f"exit code {found.returncode}: {said[-1:]}"
    # the two runs that it compares may have said theirs before
    if name == "bisect":
        own = own[-1:]
        if own and re.match("clothsim: [AB]( ended|: )", own[0]):
            return ""
    # what else there is comes from libraries that say so on their way to abort
    if len(own) != 1 or not re.search(words, own[0]):
        return f"not one line of the kind: {said}"
    return ""


def leftovers():
    return [os.path.join(folder, name) for folder, _, names in os.walk(".") for name in names
            if ".tmp." in name]


def exports(line):
    """What exports in the folder of a line hold; what is left of their making is among them."""
    folder = line[line.index("-o") + 1] if "-o" in line else ""
    return {name: open(f"{folder}/{name}", "rb").read()
            for name in (os.listdir(folder) if os.path.isdir(folder) else [])
            if re.search(r"[.](obj|pc2|vtp|npz|part|partial)$", name)}


def points(calls, wanted):
    """(number, "+" where all later ones fail too)"""
    if not wanted:
        return [(n, way) for n in range(1, calls + 1) for way in ("", "+")]
    step = max(1, -(-calls // wanted))
    return [(n, "+" if k % 2 else "") for k, n in enumerate(range(1 + step // 2, calls + 1, step))]


def try_points(fault, line, name, kind, chosen, calls, whole, files):
    """The number of points that ended as ever, and what was wrong."""
    wrong, absorbed = [], 0
    for number, way in chosen:
        if name in FRESH:
            shutil.rmtree(FRESH[name], ignore_errors=True)
        found = fault.run(line, FAULT=f"{kind}:{number}{way}")
        reason = judge(kind, found, whole, name)
        if not reason and leftovers():
            reason = f"left {leftovers()}"
        if not reason and found.returncode == 0 and exports(line) != files:
            reason = "other exports, and no word of it"
        for left in leftovers():
            os.unlink(left)
        absorbed += found.returncode == 0
        if reason:
            wrong.append(f"{number}{way} of {calls}: {reason}")
    return absorbed, wrong


def points_of(name, kind, calls, wanted):
    """OpenGL takes memory hundreds of thousands of times, and a second for a picture."""
    return points(calls, 140 if (name, kind, wanted) == ("osmesa", "memory", 0) else wanted)


def is_there(program, name, listed, wanted):
    needed = {"sundials": "cvode-bdf", "cholmod": "fast-mass-spring"}.get(name)
    if name == "osmesa":
        folder = os.path.dirname(program)
        return not wanted and os.path.exists(f"{folder}/src/draw/render-osmesa.so")
    return needed is None or f"\n{needed} " in "\n" + listed


def main():
    (program, shim), wanted = map(os.path.realpath, sys.argv[1:3]), int(sys.argv[3])
    word = sys.argv[4] if len(sys.argv) > 4 else ""
    listed = subprocess.run([program, "integrators"], capture_output=True, text=True).stdout
    fault, n, failed = Fault(program, shim), 0, 0
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        json.dump(SCENE, open("s.json", "w"))
        json.dump(SPRINGS, open("p.json", "w"))
        for line in PREPARED:
            subprocess.run([program, *line], check=True)
        for name, line in LINES.items():
            if not is_there(program, name, listed, wanted):
                continue
            calls, whole = fault.count(line)
            files = exports(line)
            # a sweep reads modules in the processes of its cells, whose calls are not counted
            calls["module"] += name == "sweep"
            for kind in KINDS:
                if word not in f"{name} {kind}" or not calls[kind]:
                    continue
                # Mesa waits for ever for a thread that it could not make
                alone = ["--isolate", "8"] if (name, kind) == ("osmesa", "thread") else []
                chosen = points_of(name, kind, calls[kind], wanted)
                absorbed, wrong = try_points(fault, line + alone, name, kind, chosen, calls[kind], whole, files)
                n += 1
                failed += bool(wrong)
                print(f"{'not ok' if wrong else 'ok'} {n} - {name}, {kind}: {len(chosen)} points of "
                      f"{calls[kind]} calls, {absorbed} ended as ever, {len(wrong)} wrong", flush=True)
                for text in wrong[:20]:
                    print(f"#   {text}")
    print(f"1..{n}")
    return failed > 0


if __name__ == "__main__":
    sys.exit(main())
