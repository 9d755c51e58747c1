#!/usr/bin/python3
"""planted.py - the tests of this folder that read sources find what they are for.

Each row plants one fault in an empty tree and names the line that the tool must print; beside it
stands what is close to the fault and none.
"""
import subprocess
import sys
import tempfile
from pathlib import Path

import sources
import tree

HERE = Path(__file__).resolve().parent
TEN = "".join(f"    total += part[{i}];\n" for i in range(10))
TORN = "one two three four five six seven eight nine ten eleven twelve thirteen\n"
PARTS = {"tests/tools/retired_words.txt": "lot chunk\n", "tests/tools/retired_names.txt": "cs_chunk lot chunk\n"}
PUBLIC = {"include/clothsim/c.h": ""}
LIMIT = {name: limit for name, _, limit, _ in tree.LIMITS}
UNIT = {f"src/base/u{i}.h": "int a;\n" for i in range(LIMIT["units"] + 1)}
HEADER = {f"src/base/h{i}.h": "int a;\n" for i in range(LIMIT["headers"] + 1)}
ROOMS = [f"r{i}" for i in range(8)]
ARROWS = {f"src/{room}/a.c": "".join(f'#include "{other}/a.h"\n' for other in ROOMS)
          for room in ROOMS}
# tool, files of the tree, what it says (None: nothing is wrong)
FAULTS = (
    ("tree.py", {"src/base/a.h": "struct cs_a { int i; };\n", "plugins/b.h": "enum cs_a { B };\n"},
     "tag cs_a is defined 2 times: src/base/a.h:1, plugins/b.h:1"),
    ("tree.py", {"src/base/a.h": "struct cs_a { int i; };\nvoid cs_a(int i);\n"},
     "cs_a is a tag (src/base/a.h:1) and a function (src/base/a.h)"),
    ("tree.py", {"src/base/a.h": "struct job { int i; };\n",
                 "src/base/b.c": "struct job { int k; };\n"},
     "tag job is defined 2 times: src/base/a.h:1, src/base/b.c:1"),
    ("tree.py", {"src/base/a.c": "struct job { int i; };\n/* text */\n",
                 "src/base/b.c": "/* struct cs_b { */\nstruct job { int k; }; // cs_job(\n"}, None),
    ("tree.py", {"src/base/a.h": "/* a */\n", "include/clothsim/a.h": "/* a */\n"},
     "header a.h stands 2 times: src/base/a.h, include/clothsim/a.h"),
    ("tree.py", UNIT, f"{LIMIT['units'] + 1} units in src (NAME.c, NAME.h or both), expected at most {LIMIT['units']}"),
    ("tree.py", HEADER, f"{LIMIT['headers'] + 1} headers in src, expected at most {LIMIT['headers']}"),
    ("tree.py", ARROWS, "56 arrows between rooms, expected at most 37"),
    ("tree.py", {"src/base/a.c": "int a;\n" * (LIMIT["code"] + 1)},
     f"{LIMIT['code'] + 1} lines of code in src, expected at most {LIMIT['code']}"),
    ("tree.py", {"src/draw/gl/a.c": "int a;\n" * (LIMIT["draw"] + 1)},
     f"{LIMIT['draw'] + 1} lines of code in draw, expected at most {LIMIT['draw']}"),
    ("tree.py", {"src/attic/a.c": "int a;\n"}, "src/attic: a room that no limit counts, see GROUPS"),
    ("tree.py", {"src/base/a.c": "/* a\n\n */\n" + "int a; /* b */\n" * 18},
     "10 % of the lines of code and comment in src are comment, expected at least 15"),
    ("floors.sh", {"plugins/a.h": '#include "b.h"\n', "plugins/b.h": '#include "a.h"\n', **PUBLIC},
     "circle: plugins/a includes b.h, plugins/b includes a.h"),
    ("floors.sh", {"plugins/a.h": "int make_a(int i);\n",
                   "plugins/b.h": '#include "a.h"\nint make_b(int i);\n',
                   "plugins/a.c": "int make_a(int i) {\n    return make_b(i);\n}\n",
                   "plugins/b.c": "int make_b(int i) {\n    return make_a(i);\n}\n", **PUBLIC},
     "circle: plugins/a names make_b of plugins/b, plugins/b includes a.h"),
    ("floors.sh", {"tools/film/a.c": "int a(const char *to) {\n    return rename(\"a\", to);\n}\n", **PUBLIC},
     "tools/film/a.c:2: writes, renames or removes a file: see base/file.h"),
    ("floors.sh", {"src/draw/a.c": "int a(const char *to) {\n    return open(to, O_RDWR | O_CREAT, 0666);\n}\n", **PUBLIC},
     "src/draw/a.c:2: writes, renames or removes a file: see base/file.h"),
    ("floors.sh", {"src/draw/a.c": "int a(const char *to) {\n    return !fopen(to, \"we\");\n}\n", **PUBLIC},
     "src/draw/a.c:2: writes, renames or removes a file: see base/file.h"),
    ("floors.sh", {"src/export/a.c": '#include "sim/a.h"\n', "src/sim/a.h": "", **PUBLIC},
     "src/export/a.c includes sim/a.h: behind the wall, see src/session"),
    ("floors.sh", {"tools/advise/a.c": '#include "model/a.h"\n', "src/model/a.h": "", **PUBLIC},
     "tools/advise/a.c includes model/a.h: behind the wall, see src/session"),
    ("floors.sh", {"bench/a.c": '#include "model/a.h"\n', "src/model/a.h": "", **PUBLIC},
     "bench/a.c includes model/a.h: behind the wall, see src/session"),
    ("floors.sh", {"tests/golden/a.h": '#include "draw/a.h"\n#include "draw/srgb.h"\n', "src/draw/a.h": "", **PUBLIC},
     "tests/golden/a.h includes draw/a.h: behind the wall, see src/session"),
    ("floors.sh", {"src/cli/a.c": "int a(const struct cs_run *run) {\n    return run->system->mass[0] > run->system->bodies[0].n;\n}\n", **PUBLIC},
     "src/cli/a.c:2: reads system->bodies: see src/session"),
    ("retired.py", {"src/base/a.c": "int cs_lot_size;\n", **PARTS},
     "src/base/a.c:1: cs_lot_size: 'lot' is retired, say chunk"),
    ("retired.py", {"src/base/a.c": "enum { CS_LOT };\n", **PARTS},
     "src/base/a.c:1: CS_LOT: 'lot' is retired, say chunk"),
    ("retired.py", {"src/base/a_lot.c": "", **PARTS},
     "src/base/a_lot.c: a_lot.c: 'lot' is retired, say chunk"),
    ("retired.py", {"src/base/a.c": "void f(const struct cs_chunk *lot);\n", **PARTS},
     "src/base/a.c:1: a cs_chunk is named 'lot', say chunk"),
    ("retired.py", {"src/base/a.c": "int cs_slot, lot, cs_lots; struct cs_spring lot; /* cs_lot */\n", **PARTS}, None),
    ("english.py", {"src/base/a.c": "/* How the width\n * is to\n * be read. */\n"},
     "src/base/a.c:2: is to be"),
    ("english.py", {"src/base/a.h": "/* a.h - what a width is. */\n"},
     "src/base/a.h:1: a comment that begins with what"),
    ("english.py", {"man/a.1.scd": "It ends, and\nso does this.\n"},
     "man/a.1.scd:1: , and so"),
    ("english.py", {"src/base/a.c": 'const char *a = "is to be"; /* somewhat it was */\n'
                                    "int b; /* what a */\n"}, None),
    ("repeats.py", {"man/a.1.scd": TORN * 2},
     "man/a.1.scd:2: as line 1: "
     "one two three four five six seven eight nine ten eleven twelve ..."),
    ("repeats.py", {"man/a.1.scd": TORN + "```\n" + TORN + "```\n" + "\n" * 9 + TORN}, None),
    ("twins.py", {"src/base/a.c": TEN, "src/base/b.c": "{\n" + TEN.replace("\n", "\n\n")},
     "src/base/a.c:1 and src/base/b.c:2 share 10 lines"),
    ("twins.py", {"src/base/a.c": TEN, "src/base/b.c": TEN.replace("[5]", "[6]")}, None),
)


def run(tool, files):
    """Exit code and lines of the tool on a tree of these files alone."""
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        for name, text in {"tests/tools/retired_words.txt": "", "tests/tools/retired_names.txt": "",
                           **files}.items():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text)
        for tree in sources.PRODUCT:
            (root / tree).mkdir(exist_ok=True)
        ended = subprocess.run([HERE / tool, root], text=True, capture_output=True,
                               check=False)
        return ended.returncode, (ended.stdout + ended.stderr).split("\n")


def main():
    checks = sources.Checks()
    for tool, files, line in FAULTS:
        code, lines = run(tool, files)
        said = f"{tool} on {', '.join(list(files)[:3])}: "
        if line is None:
            checks.check(code == 0, said + "expected nothing wrong, got " + " | ".join(lines))
        else:
            checks.check(code != 0 and line in lines,
                         said + f"expected '{line}', got " + " | ".join(lines)[:400])
    return checks.end()


if __name__ == "__main__":
    sys.exit(main())
