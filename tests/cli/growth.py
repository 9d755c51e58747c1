#!/usr/bin/python3
"""Memory of a run against its number of frames, and rows that can be followed and outlive a kill
(as TAP).

usage: growth.py PROGRAM FRAMES    against 1000 frames
"""
import json
import os
import subprocess
import sys
import tempfile
import time

sys.argv[1:] or sys.exit("usage: growth.py PROGRAM FRAMES")

SCENE = {"bodies": [{"cloth": {"grid": [2, 2]}, "mass": {"total": 1}}], "time": {"fps": 1000}}
MOST = 1000  # kB
count = bad = 0


def check(held, what, *why):
    global count, bad
    count += 1
    bad += not held
    print(f"{'' if held else 'not '}ok {count} - {what}", *([] if held else why), flush=True)


def start(program, frames, name, *more):
    return subprocess.Popen(
        [program, "run", "a.json", "-n", str(frames), "-i", "symplectic-euler:dt=0.001",
         "--no-render", "-q", "--monitor", f"{name}.csv", "--ledger", f"{name}l.csv", "--json",
         f"{name}.json", *more])


def measure(program, frames, name):
    """Exit code and the largest memory in kB."""
    process = start(program, frames, name, "-o", name, "--checkpoint", "1000")
    _, end, used = os.wait4(process.pid, 0)
    return os.waitstatus_to_exitcode(end), used.ru_maxrss


def rows(path):
    """Whole rows of a table, by the number of their frame."""
    if not os.path.exists(path):
        return []
    return [int(line.split(",")[0]) for line in open(path).read().split("\n")[1:-1]]


def main():
    program, frames = os.path.abspath(sys.argv[1]), int(sys.argv[2])
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        json.dump(SCENE, open("a.json", "w"))
        few, many = measure(program, 1000, "few"), measure(program, frames, "many")
        check(few[0] == many[0] == 0 and many[1] - few[1] < MOST,
              f"{frames} frames take {many[1] - few[1]} kB more than 1000", few, many)
        sizes = [os.path.getsize(f"{name}/run.checkpoint") for name in ("few", "many")]
        check(sizes[1] - sizes[0] < 1000, "so does the checkpoint", sizes)
        check(len(rows("many.csv")) >= frames, "all rows are there", len(rows("many.csv")))

        # without a checkpoint: what a reader sees grows, and stays after a kill
        process = start(program, 10000000, "dead")
        seen = []
        while process.poll() is None:
            time.sleep(0.05)
            found = rows("dead.csv.part")
            if found and (not seen or len(found) > len(seen[-1])):
                seen.append(found)
            if len(seen) == 3:
                break
        process.kill()
        process.wait()
        left = rows("dead.csv.part")
        check(len(seen) == 3, "rows can be followed while it runs", list(map(len, seen)))
        check(left[:len(seen[-1])] == seen[-1] and left == list(range(left[0], left[0] + len(left))),
              "a killed run leaves its rows, without a gap", len(left))
        ledger = rows("deadl.csv.part")
        check(abs(len(ledger) - len(left)) <= 1, "the ledger too, but for the last one", len(ledger))
        print(f"1..{count}")
        os.chdir("/")
    return bad > 0


if __name__ == "__main__":
    sys.exit(main())
