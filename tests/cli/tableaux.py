#!/usr/bin/python3
"""Tableaux that are files (as TAP): those of examples have their order by the conditions of all rooted
trees (Butcher 1963), the card finds it in steps, and a bad file is one line with its place.

usage: tableaux.py PROGRAM SOURCE
"""
import json
import math
import os
import subprocess
import sys
import tempfile
from fractions import Fraction
from functools import lru_cache
from pathlib import Path

program, source = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
FILES = sorted((source / "examples/tableaux").glob("*.json"))
# clothsim finds python3 as a user's shell does: let it be the one that runs this
os.environ["PATH"] = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
n = failed = 0


def told(name, good, found=""):
    global n, failed
    n += 1
    failed += not good
    print("ok" if good else "not ok", n, "-", name)
    for line in [] if good else str(found).splitlines():
        print("#  ", line)


@lru_cache(None)
def trees(nodes):
    """All rooted trees of so many nodes, each the sorted tuple of those at its root."""
    return sorted(set(forests(nodes - 1, nodes - 1)))


def forests(nodes, largest):
    if nodes == 0:
        return [()]
    return [tuple(sorted((tree, *rest))) for size in range(1, min(nodes, largest) + 1)
            for tree in trees(size) for rest in forests(nodes - size, size)]


def nodes_of(tree):
    return 1 + sum(map(nodes_of, tree))


def density(tree):
    return nodes_of(tree) * math.prod(map(density, tree))


def stage_weights(A, tree):
    """The elementary weight of a tree at each stage."""
    below = [stage_weights(A, child) for child in tree]
    return [math.prod(sum(a * w for a, w in zip(row, weights)) for weights in below) for row in A]


def order_of(A, b):
    """The order of the weights b: all trees of so many nodes have 1 / density."""
    for order in range(1, 8):
        for tree in trees(order):
            if abs(sum(w * f for w, f in zip(b, stage_weights(A, tree))) - Fraction(1, density(tree))) > 1e-12:
                return order - 1
    return 7


def fractions(row, length):
    return [Fraction(entry) for entry in row] + [Fraction(0)] * (length - len(row))


def check_orders():
    for file in FILES:
        table = json.loads(file.read_text())
        stages = len(table["b"])
        A = [fractions(row, stages) for row in table["A"]]
        found = order_of(A, fractions(table["b"], stages))
        told(f"{file.stem} has order {table['order']}", found == table["order"], f"order {found}")
        if "embedded" in table:
            lower = order_of(A, fractions(table["embedded"], stages))
            told(f"{file.stem} embeds the order below", lower == table["order"] - 1, f"order {lower}")
    told("six tableaux are shipped", len(FILES) >= 6, FILES)


def conform(file, checks):
    return subprocess.run([program, "conform", "--only", checks, f"tableau:{file}"],
                          capture_output=True, text=True)


def check_steps():
    for name, checks in (("ralston3", "order"), ("crouzeix3", "order"), ("cash-karp54", "order,tolerance")):
        done = conform(source / f"examples/tableaux/{name}.json", checks)
        told(f"{name}: {checks}", done.returncode == 0 and " 0 fail" in done.stdout, done.stdout + done.stderr)


GOOD = {"name": "good", "order": 2, "source": "tests", "A": [[], ["1/2"]], "b": [0, 1]}
# what is changed, and the line
BAD = (
    ({"b": [0, 2]}, 'b: found 2.0, expected numbers whose sum is 1'),
    ({"A": [[], ["1/x"]]}, 'A[1][0]: found "1/x", expected a number or a fraction as text, at most 10^9'),
    ({"A": [[], [10**400]]}, f"A[1][0]: found 1{59 * '0'}, expected a number or a fraction as text, at most 10^9"),
    ({"A": [[]]}, "A: found 1, expected 2 rows, as many as b has numbers"),
    ({"A": [[0, 1], ["1/2"]]}, "A[0]: found [0, 1], expected no number behind the 1th: stages follow each other"),
    ({"c": [0, "1/3"]}, "c[1]: found 0.3333333333333333, expected 0.5, the sum of A[1]"),
    ({"orders": 2}, "orders: found 2, expected one of A, b, c, embedded, name, order, source"),
    ({"order": "2"}, 'order: found "2", expected a whole number'),
)


def check_faults():
    with tempfile.TemporaryDirectory() as work:
        file = Path(work) / "bad.json"
        for change, line in BAD:
            file.write_text(json.dumps({**GOOD, **change}))
            done = conform(file, "abi")
            told(line, done.returncode == 5 and f"tableau.py: {file}: {line}\n" in done.stderr, done.stderr)
        file.write_text('{"name": "a",\n "order": 2,,\n}')
        done = conform(file, "abi")
        told("no JSON", f"tableau.py: {file}:2:13: " in done.stderr, done.stderr)
        file.write_text(json.dumps({"bodies": [{"cloth": {"grid": [3, 3]}, "mass": {"total": 1}}],
                                    "integrator": f"tableau:{FILES[0]}"}))
        done = subprocess.run([program, "run", file, "-n", "1", "--no-render"], capture_output=True, text=True)
        told("no scene starts one", done.returncode == 3 and "expected a name" in done.stderr, done.stderr)
        # a wrong coefficient that leaves the sums alone is what the order is for
        file.write_text(json.dumps({**GOOD, "b": ["1/1000", "999/1000"]}))
        done = conform(file, "solution,order")
        told("a wrong b is found", done.returncode == 1 and "FAIL" in done.stdout, done.stdout + done.stderr)


check_orders()
check_steps()
check_faults()
print(f"1..{n}")
sys.exit(failed > 0)
