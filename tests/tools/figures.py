#!/usr/bin/python3
"""figures.py ROOT - the figures of docs/reliability.md that the tree itself can count are right:
fuzz targets and their executions, scenes that go on, command lines that faults are planted in,
rows and cells of other machines, hostile deeds, and the floor of coverage."""
import re
import sys
from pathlib import Path

sys.argv[1:] or sys.exit("usage: figures.py ROOT")

root = Path(sys.argv[1])
WORDS = dict(zip("eleven twelve thirteen fourteen fifteen sixteen seventeen eighteen nineteen twenty".split(),
                 range(11, 21)))


def text_of(path):
    return (root / path).read_text(encoding="utf-8")


def executions():
    lines = text_of("tests/fuzz/executions.tsv").splitlines()[1:]
    return f"{sum(int(line.split(chr(9))[3]) for line in lines) / 1e7:.1f}"


def resumed():
    return len(re.findall(r"^ +\{SCENES", text_of("tests/physics/test_resume.c"), re.M))


def fault_lines():
    table = re.search(r"^LINES = \{(.*?)^\}", text_of("tests/faults/faults.py"), re.M | re.S)[1]
    return len(re.findall(r'^    "\w+": \[', table, re.M))


def cells_elsewhere():
    script = text_of("tests/cross/cross.sh")
    builds = re.search(r"set -- ((?:[\w-]+[\s\\]+)+)", script)[1].replace("\\", " ").split()
    return len(builds) * len(re.search(r'threads="([\d ]+)"', script)[1].split())


# what stands on the page, where its figure is the group, and what is counted
FIGURES = [
    (r"(\w+) targets for libFuzzer", lambda: len(list((root / "tests/fuzz").glob("fuzz_*.c")))),
    (r"executions.tsv` counts ([\d.]+) 10\^7", executions),
    (r"test_resume.c` \((\d+) pairs", resumed),
    (r"two allocations of each of (\w+) command lines", fault_lines),
    (r"(\d+) golden rows in", lambda: text_of("tests/cross/rows.tsv").count("\t") // 2),
    (r"golden rows in (\d+) cells", cells_elsewhere),
    # the first of them does nothing
    (r"of (\d+) hostile deeds", lambda: len(re.findall(r'^ +X\("', text_of("tests/abi/deeds.h"), re.M)) - 1),
    (r"at least ([\d.]+) % of the branches",
     lambda: text_of("tests/tools/coverage_floor.txt").strip()),
]

page = text_of("docs/reliability.md")
wrong = 0
for pattern, count in FIGURES:
    found = re.search(pattern, page)
    stands = found and str(WORDS.get(found[1], found[1]))
    if stands != str(count()):
        print(f"docs/reliability.md: found {stands} for \"{pattern}\", counted {count()}")
        wrong += 1
print(f"{len(FIGURES)} figures counted, {wrong} wrong")
sys.exit(wrong > 0)
