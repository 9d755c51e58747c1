#!/usr/bin/python3
"""Tableaux that are files (as TAP): those of examples have their order by the conditions of all rooted
trees (Butcher 1963), the card finds it in steps, our own methods have the same bits, and a bad file is one line
with its place.

usage: tableaux.py PROGRAM SOURCE
"""
import json
import math
import os
import struct
import subprocess
import sys
import tempfile
from fractions import Fraction
from functools import lru_cache
from pathlib import Path

sys.argv[1:] or sys.exit("usage: tableaux.py PROGRAM SOURCE")

program, source = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
FILES = sorted((source / "examples/tableaux").glob("*.json"))
# no method of a file needs another program
os.environ["PATH"] = "/nowhere"
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


# the coefficients of plugins/dopri5.c, esdirk.c and sdirk2.c
OWN = {
    "dopri5": {"order": 5, "c": [0, "1/5", "3/10", "4/5", "8/9", 1, 1],
               "A": [[], ["1/5"], ["3/40", "9/40"], ["44/45", "-56/15", "32/9"],
                     ["19372/6561", "-25360/2187", "64448/6561", "-212/729"],
                     ["9017/3168", "-355/33", "46732/5247", "49/176", "-5103/18656"],
                     ["35/384", 0, "500/1113", "125/192", "-2187/6784", "11/84"]],
               "b": ["35/384", 0, "500/1113", "125/192", "-2187/6784", "11/84", 0],
               "embedded": ["5179/57600", 0, "7571/16695", "393/640", "-92097/339200", "187/2100", "1/40"]},
    "esdirk": {"order": 4, "c": [0, 0.5, 0.332, 0.62, 0.85, 1],
               "A": [[], ["1/4", "1/4"], ["8611/62500", "-1743/31250", "1/4"],
                     ["5012029/34652500", "-654441/2922500", "174375/388108", "1/4"],
                     ["15267082809/155376265600", "-71443401/120774400", "730878875/902184768",
                      "2285395/8070912", "1/4"],
                     ["82889/524892", 0, "15625/83664", "69875/102672", "-2260/8211", "1/4"]],
               "b": ["82889/524892", 0, "15625/83664", "69875/102672", "-2260/8211", "1/4"],
               "embedded": ["4586570599/29645900160", 0, "178811875/945068544", "814220225/1159782912",
                            "-3700637/11593932", "61727/225920"]},
    "sdirk2": {"order": 2, "A": [[1 - 0.5**0.5], [0.5**0.5, 1 - 0.5**0.5]], "b": [0.5**0.5, 1 - 0.5**0.5]},
}


def run(method, *words, scene="drum", frames=6):
    done = subprocess.run([program, "run", source / f"scenes/{scene}.json", "-n", str(frames), "--no-render",
                           "--hash", "-q", "-i", method, *words], capture_output=True, text=True)
    return done.stdout.split()[-1] if done.returncode == 0 else done.stderr


def positions(folder, frame):
    """The numbers of a state's file."""
    data = (Path(folder) / f"x_{frame:05}.npy").read_bytes()
    begin = 10 + struct.unpack("<H", data[8:10])[0]
    return struct.unpack(f"<{(len(data) - begin) // 8}d", data[begin:])


def check_own(work):
    """A file has the bits of the method that is compiled, by the same engine."""
    file = {name: work / f"{name}.json" for name in OWN}
    for name, table in OWN.items():
        file[name].write_text(json.dumps({"name": f"{name}-file", "source": "tests", **table}))
    for options in ("", ":dt_max=1e-3,atol=1,rtol=0.1", ":rtol=1e-8"):
        for scene in ("drum", "contact_compare"):
            ours, its = (run(f"{name}{options}", scene=scene) for name in ("dopri5", f"tableau:{file['dopri5']}"))
            told(f"dopri5{options} of a file has its bits on {scene}", ours == its and len(its) == 32, f"{ours} {its}")
    ours, its = (run(f"{name}:dt=1e-3") for name in ("esdirk", f"tableau:{file['esdirk']}"))
    told("esdirk:dt=1e-3 of a file has its bits", ours == its and len(its) == 32, f"{ours} {its}")
    # 16 steps per frame of either loop; scale: the way of the drum's middle
    run("sdirk2:dt=0.00104166667,rtol=1e-12", "--states", work / "ours")
    run(f"tableau:{file['sdirk2']}:dt=0.00104166667,rtol=1e-12", "--states", work / "its")
    start, ours, its = (positions(work / folder, frame) for folder, frame in (("ours", 0), ("ours", 6), ("its", 6)))
    moved, gap = (max(abs(p - q) for p, q in zip(ours, other)) for other in (start, its))
    told("sdirk2 of a file finds the same motion", moved > 0.01 and gap < 1e-10 * moved, f"{gap} of {moved}")
    for name in ("dopri5", "esdirk", "sdirk2"):
        method = f"tableau:{file[name]}"
        run(method, "-o", work / f"part-{name}", "--checkpoint", "2", frames=4)
        whole, resumed = run(method), run(method, "--resume", work / f"part-{name}")
        told(f"{name} of a file resumes to the same bits", whole == resumed and len(whole) == 32, f"{whole} {resumed}")
    subprocess.run([program, "run", source / "scenes/drum.json", "-n", "1", "-q", "-o", work / "seen", "-i",
                    f"tableau:{file['dopri5']}"], capture_output=True)
    module = json.loads((work / "seen/run.json").read_text())["module"]
    told("a run names the file and its hash", module["file"] == str(file["dopri5"].resolve())
         and len(module["hash"]) == 32, module)
    done = subprocess.run([program, "compare", source / "scenes/drum.json", "-t", "0.05", "-q", "-o", work / "compared",
                           "-i", f"tableau:{file['dopri5']},rk4"], capture_output=True, text=True)
    told("times are compared", done.returncode == 0 and "ranked by work" not in done.stdout, done.stdout + done.stderr)


GOOD = {"name": "good", "order": 2, "source": "tests", "A": [[], ["1/2"]], "b": [0, 1]}
NUMBER = "expected a number or a fraction as text, at most 10^9"
NO_STAGE = "expected 0: there is no such stage, or it follows"
# what is changed, and the line
BAD = (
    ({"b": [0, 2]}, "1:74: b: found numbers whose sum is 2, expected 1"),
    ({"embedded": [1, 1]}, "1:94: embedded: found numbers whose sum is 2, expected 1"),
    ({"embedded": [0, 1]}, "1:94: embedded: found b again, expected a method of lower order"),
    ({"source": ""}, '1:1: missing key "source"'),
    ({"name": "rk4"}, 'is already in'),
    ({"A": [[], ["1/x"]]}, f'1:60: A[1][0]: found string "1/x", {NUMBER}'),
    ({"A": [[], ["1/0"]]}, f'1:60: A[1][0]: found string "1/0", {NUMBER}'),
    ({"A": [[], ["1e10"]]}, f'1:60: A[1][0]: found string "1e10", {NUMBER}'),
    ({"A": [[], [1e10]]}, "1:60: A[1][0]: 10000000000 is out of range (-1e+09..1e+09)"),
    ({"A": [[]]}, "1:1: found 1 rows of A and 2 numbers of b, expected as many, 1 to 35"),
    ({"A": 36 * [[]], "b": 36 * [0]},
     "1:1: found 36 rows of A and 36 numbers of b, expected as many, 1 to 35"),
    ({"A": [[0, 1], ["1/2"]]}, f"1:59: A[0][1]: found 1, {NO_STAGE}"),
    ({"A": [[], ["1/2", 0, 3]]}, f"1:70: A[1][2]: found 3, {NO_STAGE}"),
    ({"A": [[], [1, "-1/2"]]}, "1:59: A[1]: found a list of 2, expected no number below 0 on the diagonal"),
    ({"c": [0, "1/3"]}, "1:59: A[1]: found numbers whose sum is 0.5, expected 0.333333333333"),
    ({"orders": 2}, '1:82: orders: unknown key; did you mean "order"?'),
    ({"order": "2"}, '1:27: order: found string "2", expected an integer (1..20)'),
    ({"order": 21}, "1:27: order: 21 is out of range (1..20)"),
    ({"name": "Good"}, "an integrator's name may contain only [a-z0-9-]"),
)


def check_faults():
    with tempfile.TemporaryDirectory() as work:
        file = Path(work) / "bad.json"
        for change, line in BAD:
            file.write_text(json.dumps({**GOOD, **change}))
            done = conform(file, "abi")
            place = f"{file}:" if line[0] == "1" else ""
            told(line, done.returncode in (2, 5) and f"{place}{line}" in done.stderr, done.stderr)
        file.write_text('{"name": "a",\n "order": 2,,\n}')
        done = conform(file, "abi")
        told("no JSON", f"{file}:2:13: " in done.stderr, done.stderr)
        found = run(f"tableau:{FILES[-2]}:rtol=1e-3")
        told("no pair, no tolerance", "rtol: no such option" in found, found)
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
with tempfile.TemporaryDirectory() as folder:
    check_own(Path(folder))
check_faults()
print(f"1..{n}")
sys.exit(failed > 0)
