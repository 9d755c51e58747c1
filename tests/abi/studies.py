#!/usr/bin/python3
"""Studies of which one cell crashes, one hangs and one eats memory: by processes that share one
folder, by --jobs, and by GNU parallel where it is installed (as TAP).

usage: studies.py PROGRAM CELLS
"""
import csv
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time

sys.argv[1:] or sys.exit("usage: studies.py PROGRAM CELLS")

MODULE = os.environ["ABI"] + "/hostile.so"
SCENE = {"bodies": [{"cloth": {"grid": [4, 3]}, "mass": {"total": 1}}], "time": {"fps": 50},
         "integrator": {"name": "hostile"}}
count = bad = 0


def check(held, what, *why):
    global count, bad
    count += 1
    bad += not held
    print(f"{'' if held else 'not '}ok {count} - {what}", *([] if held else why))


def rows(folder):
    return list(csv.DictReader(open(folder + "/sweep.csv")))


def is_right(found, cells):
    """All cells in order, with the bits of the first but for the three."""
    wrong = {cells // 5: "crash", cells // 2: "ended at its limit", cells - 2: "out of memory"}
    return [int(row["cell"]) for row in found] == list(range(cells)) and all(
        (row["outcome"] == "failed" and wrong[k] in row["note"] and row["hash"] == "")
        if k in wrong else
        (row["outcome"] == "finished" and row["hash"] == found[0]["hash"])
        for k, row in enumerate(found))


def main():
    program, cells = os.path.abspath(sys.argv[1]), int(sys.argv[2])
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        json.dump(SCENE, open("a.json", "w"))
        deeds = ["nothing"] * cells
        deeds[cells // 5], deeds[cells // 2], deeds[cells - 2] = "write-far", "loop", "eat-memory"
        study = [program, "sweep", "a.json", "-p", MODULE, "-n", "2", "--cell-seconds", "3",
                 "--cell-memory", "300", "--strict", "-q", "-s",
                 "integrator.deed=" + ",".join(f'"{deed}"' for deed in deeds)]

        found = subprocess.run([*study, "-o", "jobs", "-j", "2"], capture_output=True, text=True)
        told = [line for line in found.stdout.splitlines() if line.startswith("failed: cell ")]
        check(found.returncode == 8 and is_right(rows("jobs"), cells),
              f"{cells} cells by --jobs: {cells - 3} right rows, exit 8", found.stderr)
        check(len(told) == 3 and all("integrator.deed=" in line for line in told),
              "three are named with their values", found.stdout)
        again = subprocess.run([*study, "-o", "jobs"], capture_output=True, text=True)
        check(again.returncode == 8 and is_right(rows("jobs"), cells), "again: nothing is run")

        # no shards: each claims its cells
        both = [subprocess.Popen([*study, "-o", "one"], stdout=subprocess.PIPE,
                                 stderr=subprocess.PIPE) for _ in range(2)]
        counts = [process.communicate() and process.returncode for process in both]
        # one ends while the other runs a last cell
        last = subprocess.run([*study, "-o", "one"], capture_output=True, text=True)
        lines = open("one/sweep.csv").read().count("\n")
        check(8 in counts and last.returncode == 8 and lines == cells + 1 and
              is_right(rows("one"), cells), "two processes fill one folder, no cell twice",
              counts, lines)

        # a signal is answered, also by a module that does not hear it
        deaf = [*study[:-1], "integrator.deed=\"loop-deaf\"", "-o", "deaf"]
        deaf[deaf.index("--cell-seconds") + 1] = "600"
        process = subprocess.Popen(deaf, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   env=dict(os.environ, SIGN=os.path.abspath("sign")))
        while process.poll() is None and not os.path.exists("sign"):
            time.sleep(0.05)
        status = subprocess.run([*deaf, "--status"], capture_output=True, text=True).stdout
        process.send_signal(signal.SIGTERM)
        process.communicate()
        check(process.returncode == 128 + signal.SIGTERM and
              status == "0 of 1 cells are in deaf/sweep.csv, 1 are being run\n",
              "a signal ends a deaf module before its limit", process.returncode, status)
        shorter = ["2" if word == "3" else word for word in study]
        retried = subprocess.run([*shorter, "-o", "jobs", "--retry-failed"], capture_output=True)
        check(retried.returncode == 8 and is_right(rows("jobs"), cells) and
              "2 s" in rows("jobs")[cells // 2]["note"], "--retry-failed runs the three again",
              retried.returncode, [row["note"] for row in rows("jobs") if row["note"]])

        if shutil.which("parallel") and cells > 100:
            subprocess.run(["parallel", "--jobs", "2", "--quote", *study, "--shard", "{}/8", "-o",
                            "part{}", ":::", *map(str, range(1, 9))], capture_output=True)
            merged = subprocess.run([program, "merge", *(f"part{k}" for k in range(1, 9)), "-o",
                                     "whole"], capture_output=True, text=True)
            last = subprocess.run([*study, "-o", "whole"], capture_output=True, text=True)
            check(last.returncode == 8 and is_right(rows("whole"), cells),
                  "the same by GNU parallel, in shards", merged.stderr, last.stderr)
        print(f"1..{count}")
        os.chdir("/")
    return bad > 0


if __name__ == "__main__":
    sys.exit(main())
