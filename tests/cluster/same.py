#!/usr/bin/python3
"""same.py SERIAL OTHER - both sweep.csv have the same rows, but for processor time, machine and the check of both."""
import csv
import sys

sys.argv[1:] or sys.exit("usage: same.py SERIAL OTHER")


def rows(path):
    with open(path, newline="") as file:
        return [{k: v for k, v in row.items() if k not in ("cpu", "machine", "check")}
                for row in csv.DictReader(file)]


serial, other = (rows(path) for path in sys.argv[1:3])
if serial != other:
    differ = sum(a != b for a, b in zip(serial, other))
    print(f"# {len(serial)} rows and {len(other)}, of which {differ} differ")
    sys.exit(1)
