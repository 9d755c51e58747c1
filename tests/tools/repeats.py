#!/usr/bin/python3
"""repeats.py ROOT - no paragraph of a manual page stands twice, whole or torn, within ten lines.

A merge that went wrong leaves both versions of a passage, cut off anywhere: looked for are WORDS
equal words in the same order that begin again no more than LINES source lines further on.
"""
import re
import sys
from pathlib import Path

import sources

sys.argv[1:] or sys.exit("usage: repeats.py ROOT")

WORDS, LINES = 12, 10


def words(text):
    """(word, line) of the page, but for examples between ``` and comments."""
    prose = re.sub(r"^```.*?^```|^;[^\n]*", sources.spaces, text, flags=re.M | re.S)
    return [(word, number) for number, line in enumerate(prose.split("\n"), 1)
            for word in re.findall(r"[\w.,:;()-]*\w[\w.,:;()-]*", line)]


def repeats(text):
    """(first line, line of the repeat, words) of each passage that stands twice."""
    found, seen, row, skip = [], {}, words(text), 0
    for i in range(len(row) - WORDS + 1):
        window = tuple(word for word, _ in row[i:i + WORDS])
        before = seen.get(window)
        # passages that overlap are one
        if before and row[i][1] - before <= LINES and i >= skip:
            found.append((before, row[i][1], " ".join(window)))
            skip = i + WORDS
        seen[window] = row[i][1]
    return found


def main():
    root = Path(sys.argv[1])
    checks = sources.Checks()
    for path in sorted((root / "man").glob("*.scd")):
        rows = repeats(path.read_text())
        name = path.relative_to(root)
        checks.check(not rows, "\n".join(f"{name}:{again}: as line {first}: {what} ..."
                                         for first, again, what in rows))
    return checks.end()


if __name__ == "__main__":
    sys.exit(main())
