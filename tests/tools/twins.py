#!/usr/bin/python3
"""twins.py ROOT - no two places of src and tools share ten or more equal lines.

Lines are trimmed; lines without a letter or digit (blank, braces), #include lines and rows of a
table of calls (.name = value,) are left out: what fills in one contract looks alike.
Such a pair is one mechanism written twice: it becomes one function.
"""
import re
import sys
from collections import defaultdict
from pathlib import Path

import sources

sys.argv[1:] or sys.exit("usage: twins.py ROOT")

LINES = 10


def lines(text):
    """(number, line) of what counts."""
    return [(number, line.strip()) for number, line in enumerate(text.split("\n"), 1)
            if re.search(r"\w", line) and not re.match(r"\s*(#\s*include\b|\.\w+ = )", line)]


def twins(files):
    """Pairs of places (path, index) at which LINES equal lines begin, the first of each passage."""
    places = defaultdict(list)
    for path, rows in files.items():
        for i in range(len(rows) - LINES + 1):
            places["\n".join(line for _, line in rows[i:i + LINES])].append((path, i))
    pairs = {(a, b) for at in places.values() for k, a in enumerate(at) for b in at[k + 1:]}
    return sorted((a, b) for a, b in pairs if ((a[0], a[1] - 1), (b[0], b[1] - 1)) not in pairs)


def length(files, a, b):
    """How many lines are equal from there on."""
    (path, i), (other, k) = a, b
    rest = zip(files[path][i:], files[other][k:])
    return next((n for n, (one, two) in enumerate(rest) if one[1] != two[1]),
                min(len(files[path]) - i, len(files[other]) - k))


def main():
    root = Path(sys.argv[1])
    files = {str(path.relative_to(root)): lines(path.read_text())
             for path in sources.files(root, ("src", "tools"))}
    checks = sources.Checks()
    faults = defaultdict(list)
    for a, b in twins(files):
        faults[a[0]].append(f"{a[0]}:{files[a[0]][a[1]][0]} and {b[0]}:{files[b[0]][b[1]][0]} "
                            f"share {length(files, a, b)} lines")
    for path in files:
        checks.check(path not in faults, "\n".join(faults[path]))
    return checks.end()


if __name__ == "__main__":
    sys.exit(main())
