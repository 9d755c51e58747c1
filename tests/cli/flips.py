#!/usr/bin/env python3
"""flips.py CLOTHSIM STRIDE - bytes of a comparison's folder changed one at a time (as TAP).

A changed byte is found by the command that reads the file, or the rows that this command writes
are those of before: it was in what is not read, or what it was in is computed again."""
import csv
import pathlib
import shutil
import subprocess
import sys
import tempfile

SCENE = """{"bodies": [{"cloth": {"grid": [3, 3]}, "mass": {"total": 0.1}, "springs": {"stretch": 40},
 "pins": ["top"]}], "time": {"fps": 20}}"""
COMPARE = ["compare", "a.json", "-i", "rk4:dt=5e-3", "--reference", "rk4:dt=1e-3", "--reference",
           "dopri5:rtol=1e-11,atol=1e-11", "-t", "0.05", "--runs", "1", "-q", "-o", "c"]
CLOCK = {"cpu", "cpu_low", "cpu_high", "wall", "runs", "outliers", "check"}


def run(program, folder, words):
    return subprocess.run([program, *words], cwd=folder, capture_output=True, timeout=120)


def rows(folder):
    with open(folder / "c/compare.csv", newline="") as file:
        return [{k: v for k, v in row.items() if k not in CLOCK} for row in csv.DictReader(file)]


def is_harmless(program, folder, name, wanted):
    """True if the change is refused, or the study gives its rows again. What is in origin.json is
    run as it stands there: the row is equal, or it is said what differs."""
    if name == "origin.json":
        found = run(program, folder, ["reproduce", "c/compare.csv:1", "-q"])
        return found.returncode == 0 or (found.returncode < 128 and found.stderr.count(b"\n") == 1)
    ended = run(program, folder, COMPARE)
    return ended.returncode == 4 or (ended.returncode == 0 and rows(folder) == wanted)


def main():
    program, stride = str(pathlib.Path(sys.argv[1]).resolve()), int(sys.argv[2])
    work = pathlib.Path(tempfile.mkdtemp())
    (work / "a.json").write_text(SCENE)
    assert run(program, work, COMPARE).returncode == 0
    wanted = rows(work)
    shutil.copytree(work / "c", work / "whole")
    files = [work / "whole" / "compare.csv", work / "whole" / "origin.json",
             *sorted((work / "whole").glob("reference-*.state"))]
    bad = 0
    for number, file in enumerate(files, 1):
        whole, wrong, unseen = file.read_bytes(), [], []
        places = range(number % stride, len(whole), stride)
        for at in places:
            shutil.rmtree(work / "c")
            shutil.copytree(work / "whole", work / "c")
            changed = bytearray(whole)
            changed[at] ^= 1 << at % 8
            (work / "c" / file.name).write_bytes(changed)
            if run(program, work, ["verify", "c", "-q"]).returncode != 1:
                unseen.append(at)
            if not is_harmless(program, work, file.name, wanted):
                wrong.append(at)
        good = places and not wrong and not unseen
        bad += not good
        print(f"{'ok' if good else 'not ok'} {number} - {file.name.split('-')[0]}: {len(places)} bytes, "
              f"believed {wrong}, not seen by verify {unseen}")
    print(f"1..{len(files)}")
    shutil.rmtree(work)
    return bad > 0


sys.exit(main())
