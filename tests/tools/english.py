#!/usr/bin/python3
"""english.py ROOT - no pattern of a translated sentence.

Looked at are comments of src, tools, plugins, include (those that begin at the left margin head a file or
a declaration), manual pages, docs, README, CONTRIBUTING; line breaks count as spaces.
"""
import re
import sys
from pathlib import Path

import sources

sys.argv[1:] or sys.exit("usage: english.py ROOT")

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


def main():
    checks = sources.Checks()
    for name, rows in matches(Path(sys.argv[1])).items():
        checks.check(not rows, "\n".join(f"{name}:{line}: {what}" for line, what in rows))
    return checks.end()


if __name__ == "__main__":
    sys.exit(main())
