#!/usr/bin/env python3
"""english.py ROOT [--accept] - patterns of a translated sentence, in text that is new.

Looked at are comments of src, plugins, include (those that begin at the left margin head a file or
a declaration), manual pages, docs, README, CONTRIBUTING; line breaks count as spaces.
english_allowed.txt says how many matches of old text a file may have, and only shrinks: fewer than
allowed is a failure too. --accept writes it anew with what is there; what a file has more than
before must come out of files that are gone, as where text moved. --list shows every match.
"""
import re
import sys
from pathlib import Path

import sources

ALLOWED = Path("tests/tools/english_allowed.txt")
PATTERN = re.compile(r"\b(?:is\s+to\s+be|comes?\s+of|an\s+own|anew|"
                     r"what\s+(?:it|they)\s+(?:is|was|has|makes|stands))\b"
                     r"|,\s+and\s+so\b|;\s+so\b", re.I)
# "name.h - Whether ..." and "Whether ..."
HEAD = re.compile(r"(?:[\w./]+ - )?(What|Whether|Those|Of|That)\b", re.I)
MARGIN = re.compile(r"^[ \t]*(?:/\*+|//+|\*(?!/))[ \t]?|\*/$", re.M)


def blanked(match):
    return " " * len(match.group(0))


def comment_matches(text):
    """(line, what was found) in the comments of a C file."""
    for first, column, comment in sources.comments(text):
        inner = MARGIN.sub(blanked, comment)
        head = HEAD.match(inner.strip())
        if column == 0 and head:
            yield first, f"a comment that begins with {head.group(1)}"
        for m in PATTERN.finditer(inner):
            yield first + inner.count("\n", 0, m.start()), " ".join(m.group(0).split())


def page_matches(text):
    for m in PATTERN.finditer(text):
        yield text.count("\n", 0, m.start()) + 1, " ".join(m.group(0).split())


def matches(root):
    """The matches of each file that has some."""
    pages = [*(root / "man").glob("*.scd"), *(root / "docs").rglob("*.md"),
             *root.glob("README.md"), *root.glob("CONTRIBUTING.md")]
    found = {path: list(comment_matches(path.read_text())) for path in sources.files(root)}
    found.update((path, list(page_matches(path.read_text()))) for path in sorted(pages))
    return {str(path.relative_to(root)): rows for path, rows in found.items()}


def read_allowed(path):
    rows = [line.split() for line in path.read_text().split("\n") if line and line[0] != "#"]
    return {name: int(count) for count, name in rows}


def accept(path, allowed, found):
    """Writes what is there, where no file has more than before but what files that are gone had."""
    counts = {name: len(rows) for name, rows in sorted(found.items()) if rows}
    grown = {name: n - allowed.get(name, 0) for name, n in counts.items()}
    more = {name: n for name, n in grown.items() if n > 0}
    gone = sum(n for name, n in allowed.items() if name not in found)
    if sum(more.values()) > gone:
        print(f"{sum(more.values())} more than allowed, where files that are gone had {gone}:",
              *(f"{n} more in {name}" for name, n in more.items()), sep="\n")
        return 1
    path.write_text("# matches that english.py allows in a file: only fewer\n"
                    + "".join(f"{n} {name}\n" for name, n in counts.items()))
    print(f"{path}: {sum(allowed.values())} before, {sum(counts.values())} now")
    return 0


def main():
    root = Path(sys.argv[1])
    found, allowed = matches(root), read_allowed(root / ALLOWED)
    if "--list" in sys.argv:
        print(*(f"{name}:{line}: {what}" for name, rows in found.items() for line, what in rows),
              sep="\n")
    if "--accept" in sys.argv:
        return accept(root / ALLOWED, allowed, found)
    checks = sources.Checks()
    for name, rows in found.items():
        limit = allowed.get(name, 0)
        where = ", ".join(f"line {line}: {what}" for line, what in rows)
        checks.check(len(rows) <= limit, f"{name}: {len(rows)} where {limit} are allowed: {where}")
        checks.check(len(rows) >= limit,
                     f"{ALLOWED}: '{limit} {name}' must become '{len(rows)} {name}'")
    for name in sorted(set(allowed) - set(found)):
        checks.check(False, f"{ALLOWED}: no file {name}: take out '{allowed[name]} {name}'")
    return checks.end()


if __name__ == "__main__":
    sys.exit(main())
