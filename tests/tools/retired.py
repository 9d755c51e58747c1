#!/usr/bin/python3
"""retired.py ROOT - no name has a word that was retired.

Looked at are cs_* and CS_* identifiers and names of files in src, tools, plugins, include, part by part
between underscores, without regard to case. retired_words.txt has the words with what the field says.
Parameters, members and locals have their type's word, or that of their role: retired_names.txt has a
type, a name that such a thing had, and the name that it has now.
"""
import re
import sys
from pathlib import Path

import sources

sys.argv[1:] or sys.exit("usage: retired.py ROOT")

HERE = Path("tests/tools")
NAME = re.compile(r"\b(?:cs|CS)_\w+")
DECLARED = re.compile(r"\b(?:struct|enum) (cs_\w+) (?:const )?\**(\w+)")


def entries(path):
    """The lines of a list, split at the first blank; # begins a comment."""
    lines = [line for line in path.read_text().split("\n") if line and not line.startswith("#")]
    return dict((line + " ").split(" ", 1) for line in lines)


def line(text, m):
    return text.count("\n", 0, m.start()) + 1


def names(codes):
    """Each name with the place where it stands first; a guard is its file's name over again."""
    found = {}
    for place, text in codes.items():
        found.setdefault(place.name, place)
        for m in NAME.finditer(text):
            if m.group(0) not in found and not m.group(0).endswith("_H"):
                found[m.group(0)] = f"{place}:{line(text, m)}"
    return found


def retired_part(name, words):
    return next((part for part in re.split(r"[_.]", name.lower()) if part in words), None)


def declared(codes):
    """(type, name) of each thing that a struct or an enum is declared by, with its first place."""
    found = {}
    for place, text in codes.items():
        for m in DECLARED.finditer(text):
            if m.groups() not in found:
                found[m.groups()] = f"{place}:{line(text, m)}"
    return found


def main():
    root = Path(sys.argv[1])
    words = entries(root / HERE / "retired_words.txt")
    codes = {path.relative_to(root): sources.code_of(path.read_text()) for path in sources.files(root)}
    found = names(codes)
    checks = sources.Checks()
    for name, place in sorted(found.items()):
        word = retired_part(name, words)
        checks.check(not word, f"{place}: {name}: '{word}' is retired, say {words.get(word, '').strip()}")
    retired = dict(line.rsplit(" ", 1) for line in (root / HERE / "retired_names.txt").read_text().splitlines())
    for (kind, name), place in sorted(declared(codes).items()):
        now = retired.get(f"{kind} {name}")
        checks.check(not now, f"{place}: a {kind} is named '{name}', say {now}")
    return checks.end()


if __name__ == "__main__":
    sys.exit(main())
