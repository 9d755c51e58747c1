#!/usr/bin/python3
"""tree.py ROOT - one definition a tag, one header a name, and the limits of size below.

A unit is NAME.c, NAME.h or both. A room is a first folder of src (its sub-folders belong to it),
plugins, or include; tools, which may include all of src, are none. An arrow is a room that includes
a file of another one. Lines of code are neither blank nor only comment.
"""
import re
import sys
from collections import defaultdict
from pathlib import Path

import sources

# rooms of src whose lines of code are counted together
GROUPS = {
    "core": ("base", "mesh", "scene", "model", "sim"),
    "draw": ("draw",),
    "study": ("session", "export", "diagram", "study"),
    "cli": ("cli",),
}
# the figure, its limit, what it is
# lowered with each thing that is made smaller
LIMITS = (
    ("units", "most", 293, "units in src (NAME.c, NAME.h or both)"),
    ("headers", "most", 176, "headers in src"),
    ("arrows", "most", 37, "arrows between rooms"),
    ("code", "most", 60891, "lines of code in src"),
    ("core", "most", 37000, "lines of code in base, mesh, scene, model and sim"),
    ("draw", "most", 6286, "lines of code in draw"),
    ("study", "most", 11918, "lines of code in session, export, diagram and study"),
    ("cli", "most", 5687, "lines of code in cli"),
    ("comments", "least", 15.0, "% of the lines of code and comment in src are comment"),
)
# a type that one header declares, and that alternatives define: no program sees two of them
ALTERNATIVES = {
    "cs_canvas": {"src/draw/cpu/canvas.c", "src/draw/gl/canvas.c"},
}
TAG = re.compile(r"\b(?:struct|union|enum)\s+(\w+)\s*\{")
# a declaration or definition at the left margin
FUNCTION = re.compile(r"^[a-z][\w *]*?\b(cs_\w+)\(", re.M)
INCLUDE = re.compile(r'^\s*#\s*include\s+(?:"([^"]+)"|<(clothsim/[^>]+)>)', re.M)


def tags(texts):
    """Places of the definitions of each tag that more than one file can see."""
    places = defaultdict(list)
    for path, text in texts.items():
        for m in TAG.finditer(text):
            places[m.group(1)].append(f"{path}:{text.count(chr(10), 0, m.start()) + 1}")
    # a tag of one .c has no prefix and stays in it; it may not hide one of a header
    return {tag: at for tag, at in places.items()
            if tag.startswith("cs_") or any(".h:" in place for place in at)}


def check_tags(checks, texts):
    functions = {m.group(1): path for path, text in texts.items() for m in FUNCTION.finditer(text)}
    for tag, places in sorted(tags(texts).items()):
        homes = {place.rsplit(":", 1)[0] for place in places}
        checks.check(len(places) == 1 or homes == ALTERNATIVES.get(tag),
                     f"tag {tag} is defined {len(places)} times: {', '.join(places)}")
        checks.check(tag not in functions,
                     f"{tag} is a tag ({places[0]}) and a function ({functions.get(tag)})")


def check_headers(checks, paths):
    homes = defaultdict(list)
    for path in paths:
        if path.suffix == ".h":
            homes[path.name].append(str(path))
    for name, places in sorted(homes.items()):
        checks.check(len(places) == 1,
                     f"header {name} stands {len(places)} times: {', '.join(places)}")


def room_of(path):
    return path.parts[1] if path.parts[0] == "src" else path.parts[0]


def arrows(texts):
    """Pairs of rooms, the first of which includes a file of the second."""
    found = set()
    for path, text in texts.items():
        for quoted, public in INCLUDE.findall(text):
            # plugins name the headers beside them without a folder
            inside = quoted.split("/")[0] if "/" in quoted else room_of(path)
            found.add((room_of(path), "include" if public else inside))
    return {(start, end) for start, end in found if start != end}


def check_groups(checks, paths):
    known = {room for rooms in GROUPS.values() for room in rooms}
    for room in sorted({room_of(path) for path in paths} - known):
        checks.check(False, f"src/{room}: a room that no limit counts, see GROUPS")


def lines(raw, bare):
    """Numbers of lines with code and of lines with nothing but comment."""
    code = sum(1 for line in bare.split("\n") if line.strip())
    return code, sum(1 for line in raw.split("\n") if line.strip()) - code


def main():
    sys.argv[1:] or sys.exit("usage: tree.py ROOT")
    root = Path(sys.argv[1])
    raw = {path.relative_to(root): path.read_text() for path in sources.files(root)}
    # names of included files are strings: kept for the arrows
    bare = {path: sources.without_comments(text) for path, text in raw.items()}
    rooms = {path: text for path, text in bare.items() if path.parts[0] != "tools"}
    src = [path for path in raw if path.parts[0] == "src"]
    checks = sources.Checks()
    check_tags(checks, {path: sources.code_of(text) for path, text in raw.items()})
    check_headers(checks, raw)

    check_groups(checks, src)
    counts = {path: lines(raw[path], bare[path]) for path in src}
    code, comments = map(sum, zip(*counts.values()))
    figures = {
        "units": len({path.with_suffix("") for path in src}),
        "headers": sum(path.suffix == ".h" for path in src),
        "arrows": len(arrows(rooms)),
        "code": code,
        "comments": 100 * comments / (code + comments),
    }
    for group, members in GROUPS.items():
        figures[group] = sum(n for path, (n, _) in counts.items() if room_of(path) in members)
    for name, kind, limit, what in LIMITS:
        value = figures[name]
        held = value <= limit if kind == "most" else value >= limit
        checks.check(held, f"{value:.6g} {what}, expected at {kind} {limit:g}")
    if "--list" in sys.argv:
        print(*(f"{start} -> {end}" for start, end in sorted(arrows(rooms))), sep="\n")
        print(*(f"{value:.6g} {name}" for name, value in figures.items()), sep="\n")
    return checks.end()


if __name__ == "__main__":
    sys.exit(main())
