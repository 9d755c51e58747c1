#!/usr/bin/env python3
"""retired.py ROOT [--accept] - no new name has a word that was retired.

Looked at are cs_* and CS_* identifiers and names of files in src, plugins, include, part by part
between underscores, without regard to case. retired_words.txt has the words with what the field
says; retired_exceptions.txt the names that still have one, and only shrinks: a line that is no
longer needed is a failure too, and --accept takes such lines out.
"""
import re
import sys
from pathlib import Path

import sources

HERE = Path("tests/tools")
NAME = re.compile(r"\b(?:cs|CS)_\w+")


def entries(path):
    """The lines of a list, split at the first blank; # begins a comment."""
    lines = [line for line in path.read_text().split("\n") if line and not line.startswith("#")]
    return dict((line + " ").split(" ", 1) for line in lines)


def names(root):
    """Each name with the place where it stands first; a guard is its file's name over again."""
    found = {}
    for path in sources.files(root):
        place = path.relative_to(root)
        found.setdefault(path.name, place)
        text = sources.code_of(path.read_text())
        for m in NAME.finditer(text):
            if not m.group(0).endswith("_H"):
                found.setdefault(m.group(0), f"{place}:{text.count(chr(10), 0, m.start()) + 1}")
    return found


def retired_part(name, words):
    return next((part for part in re.split(r"[_.]", name.lower()) if part in words), None)


def accept(path, stale):
    lines = path.read_text().split("\n")
    path.write_text("\n".join(line for line in lines if line not in stale))
    print(f"{path}: {len(stale)} lines taken out")


def main():
    root = Path(sys.argv[1])
    words = entries(root / HERE / "retired_words.txt")
    exceptions = entries(root / HERE / "retired_exceptions.txt")
    found = names(root)
    stale = {name for name in exceptions if name not in found or not retired_part(name, words)}
    if "--accept" in sys.argv:
        accept(root / HERE / "retired_exceptions.txt", stale)
        return 0
    checks = sources.Checks()
    for name, place in sorted(found.items()):
        word = retired_part(name, words)
        checks.check(not word or name in exceptions,
                     f"{place}: {name}: '{word}' is retired, say {words.get(word, '').strip()}")
    for name in sorted(stale):
        checks.check(False, f"{HERE}/retired_exceptions.txt: {name} is no longer needed: "
                            "retired.py ROOT --accept takes it out")
    return checks.end()


if __name__ == "__main__":
    sys.exit(main())
