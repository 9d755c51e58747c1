#!/usr/bin/python3
"""Lets a module do each of its deeds in commands, and holds how they end to what is promised: the
command fails and names the module, a study has a row that says so, or no bit is another one (as
TAP).

usage: deeds.py PROGRAM COMMAND...    COMMAND: run, sweep, compare, conform,
                                      stability, or all; of
                                      "all" those that hang too, seconds each
"""
import csv
import json
import os
import re
import subprocess
import sys
import tempfile

sys.argv[1:] or sys.exit("usage: deeds.py PROGRAM COMMAND...")

MODULE = os.environ["ABI"] + "/hostile.so"
SCENE = {"bodies": [{"cloth": {"grid": [4, 3]}, "mass": {"total": 1}}], "time": {"fps": 50},
         "integrator": {"name": "hostile"}}
# deeds that end at a limit
SLOW = ("hang", "loop", "stop", "alarm", "eat", "no-time")
COMMANDS = {
    "run": ["run", "a.json", "-n", "2", "--no-render", "-q", "--hash", "--isolate", "1", "-i"],
    "compare": ["compare", "a.json", "-t", "0.04", "-q", "--runs", "1", "--budget", "0.2", "-y",
                "--strict", "-i"],
    "stability": ["stability", "a.json", "-n", "2", "-q", "--budget", "0.2", "--columns", "2",
                  "--rows", "2", "--dt", "0.002..0.02", "-j", "1", "-o", "m", "-y", "-i"],
    "conform": ["conform", "-q", "--only", "pins", "--isolate", "1"],
}


def clothsim(program, *line):
    """Exit code, output and errors; "late" after 1200 s, which only ends what hangs."""
    limit = "ulimit -v 4000000; exec \"$@\""
    try:
        found = subprocess.run(["sh", "-c", limit, "sh", program, *line], capture_output=True,
                               timeout=1200, text=True, errors="replace")
        return found.returncode, found.stdout, found.stderr
    except subprocess.TimeoutExpired:
        return "late", "", ""


def deeds(program):
    said = clothsim(program, "run", "a.json", "-p", MODULE, "-i", "hostile:deed=what")[2]
    return re.search(r"[(](nothing, .*)[)]", said).group(1).split(", ")


def judge(command, honest, found):
    """What is wrong with the end of a command, or nothing."""
    code, out, said = found
    if code == 0:
        same = out == honest[1] or command != "run" or "not finite" in said
        return "" if same else f"exit 0 with other bits: {out}{said} for {honest[1]}"
    named = re.search(r'"hostile"|hostile:|cell.* failed|not finite|blew up|interrupted', out + said)
    return "" if code != "late" and named else f"exit {code}: {said[-200:]}"


def sweep(program, names):
    """A cell for each deed: the row of a finished one has the bits of an honest one."""
    values = ",".join(f'"{name}"' for name in names)
    code, out, said = clothsim(program, "sweep", "a.json", "-p", MODULE, "-s",
                               f"integrator.deed={values}", "-n", "2", "-o", "s", "-j", "2",
                               "--cell-seconds", "1", "--cell-memory", "500", "-y", "--strict")
    rows = list(csv.DictReader(open("s/sweep.csv"))) if os.path.exists("s/sweep.csv") else []
    wrong = [] if code == 8 and len(rows) == len(names) else [f"exit {code}: {said[-200:]}"]
    for row in rows:
        honest = row["outcome"] == "finished" and row["hash"] == rows[0]["hash"]
        told = row["outcome"] in ("failed", "blew up: not finite")
        if not honest and not told:
            wrong.append(f"{row['integrator.deed']}: {row['outcome']}")
    failed = sum(row["outcome"] == "failed" for row in rows)
    return wrong + ([] if failed > len(rows) // 2 else [f"only {failed} failed"])


def main():
    program, asked = os.path.abspath(sys.argv[1]), sys.argv[2:]
    whole = asked == ["all"]
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        json.dump(SCENE, open("a.json", "w"))
        names = deeds(program)
        quick = names if whole else [name for name in names if not name.startswith(SLOW)]
        count, bad = 0, 0
        for command in ["sweep", *COMMANDS] if whole else asked:
            if command == "sweep":
                wrong = sweep(program, names)
            else:
                line = COMMANDS[command]
                # conform takes the method as its operand
                end = [line[-1]] if line[-1] == "-i" else []
                call = lambda name: clothsim(program, *line[:len(line) - len(end)], "-p", MODULE,
                                             *end, f"hostile:deed={name},dt=0.02")
                honest = call("nothing")
                ends = {name: judge(command, honest, call(name)) for name in quick}
                wrong = [f"{name}: {why}" for name, why in ends.items() if why]
                if honest[0] not in (0, 1):
                    wrong.append(f"nothing: exit {honest[0]}: {honest[2][-200:]}")
            count += 1
            bad += bool(wrong)
            print(f"{'not ' if wrong else ''}ok {count} - {command}: {len(names)} deeds")
            for text in wrong:
                print("# " + text.replace("\n", " "))
        print(f"1..{count}")
        os.chdir("/")
    return bad > 0


if __name__ == "__main__":
    sys.exit(main())
