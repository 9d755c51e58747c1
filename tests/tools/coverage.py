#!/usr/bin/python3
"""Counts the branches that tests took, prints them by folder, and holds a floor that only rises.

usage: coverage.py ROOT BUILD    BUILD was compiled with --coverage, and its tests have run
       coverage.py ROOT          the floor has never been lowered, as far as git can tell

A branch is an outcome of a condition, as gcov counts them. Of a function that stands in several
programs, or of a line in a header, an outcome is taken if any of them took it. Code that no test
loaded counts as not taken, and what a child does that ends by _exit, such as a drawing by cairo, is not
seen. Less than the floor fails; more by RISE raises it in its file.
"""
import collections
import json
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

sys.argv[1:] or sys.exit("usage: coverage.py ROOT BUILD")

FLOOR = "tests/tools/coverage_floor.txt"
FOLDERS = ("src", "plugins", "tools")
MARGIN = 0.2  # %, above what threads and signals change from run to run
RISE = 2 * MARGIN
BATCH = 40


def read_counts(notes, folder):
    """The documents of gcov for some files, whose counts lie beside them."""
    out = subprocess.run(["gcov", "--json-format", "--stdout", "--branch-probabilities", *notes],
                         cwd=folder, check=True, capture_output=True, text=True).stdout
    return [json.loads(line) for line in out.splitlines() if line.startswith("{")]


def find_branches(root, build):
    """For each outcome of a condition in the sources whether it was taken."""
    taken = collections.defaultdict(bool)
    notes = sorted(str(path) for path in build.rglob("*.gcno"))
    if not any(build.rglob("*.gcda")):
        sys.exit(f"coverage: no test has run in {build}")
    with tempfile.TemporaryDirectory() as folder:
        for k in range(0, len(notes), BATCH):
            for unit in read_counts(notes[k:k + BATCH], folder):
                for file in unit["files"]:
                    path = os.path.relpath(
                        os.path.join(unit["current_working_directory"], file["file"]), root)
                    if path.split("/")[0] not in FOLDERS:
                        continue
                    for line in file["lines"]:
                        for b, branch in enumerate(line["branches"]):
                            taken[path, line["line_number"], b] |= branch["count"] > 0
    return taken


def print_folders(taken):
    of = collections.Counter(os.path.dirname(path) for path, _, _ in taken)
    hit = collections.Counter(os.path.dirname(path) for (path, _, _), yes in taken.items() if yes)
    for folder in sorted(of):
        print(f"{100 * hit[folder] / of[folder]:6.1f} %  {hit[folder]:6} of {of[folder]:6}  {folder}")


def compare_with_floor(root, taken):
    floor = float((root / FLOOR).read_text())
    share = 100 * sum(taken.values()) / len(taken)
    print(f"{share:6.1f} %  {sum(taken.values()):6} of {len(taken):6}  in all; the floor is {floor}")
    if share < floor:
        sys.exit(f"coverage: {share:.2f} % of the branches are taken, expected at least {floor} %")
    if share >= floor + RISE:
        raised = math.floor(10 * (share - MARGIN)) / 10
        (root / FLOOR).write_text(f"{raised}\n")
        print(f"coverage: the floor is now {raised}; commit {FLOOR}")


def check_history(root):
    """Each version of the file is above the one before."""
    now = float((root / FLOOR).read_text())
    log = subprocess.run(["git", "log", "--reverse", "--format=", "-p", "--", FLOOR], cwd=root,
                         capture_output=True, text=True)
    known = [float(line[1:]) for line in log.stdout.splitlines()
             if line.startswith("+") and not line.startswith("+++")] + [now]
    for before, after in zip(known, known[1:]):
        if after < before:
            sys.exit(f"coverage: {FLOOR}: found {after} after {before}; the floor only rises")
    print(f"coverage: the floor is {now} %, in {len(known) - 1} versions never lower")


def main():
    root = Path(sys.argv[1]).resolve()
    if len(sys.argv) == 2:
        check_history(root)
        return
    taken = find_branches(root, Path(sys.argv[2]).resolve())
    print_folders(taken)
    compare_with_floor(root, taken)


main()
