#!/usr/bin/python3
"""flips.py CLOTHSIM STRIDE - bytes of the folders of a comparison, a sweep and of parts that are
merged, changed one at a time (as TAP).

A changed byte is found by the command that reads the file, or the rows that this command writes
are those of before: it was in what is not read, or what it was in is computed again."""
import csv
import pathlib
import shutil
import subprocess
import sys
import tempfile

sys.argv[1:] or sys.exit("usage: flips.py CLOTHSIM STRIDE")

SCENE = """{"bodies": [{"cloth": {"grid": [3, 3]}, "mass": {"total": 0.1}, "springs": {"stretch": 40},
 "pins": ["top"]}], "time": {"fps": 20}}"""
COMPARE = ["compare", "a.json", "-i", "rk4:dt=5e-3", "--reference", "rk4:dt=1e-3", "--reference",
           "dopri5:rtol=1e-11,atol=1e-11", "-t", "0.05", "--runs", "1", "-q", "-o", "c"]
SWEEP = ["sweep", "a.json", "-s", "forces.drag=0,0.1", "-i", "rk4", "-n", "1", "-q", "-o", "s"]
MAP = ["stability", "a.json", "-i", "rk4", "--columns", "2", "--rows", "2", "-t", "0.1", "-q", "-j", "1"]
CLOCK = {"cpu", "cpu_low", "cpu_high", "wall", "runs", "outliers", "check"}


def run(program, folder, words):
    return subprocess.run([program, *words], cwd=folder, capture_output=True, timeout=1200)


def rows(folder, table="c/compare.csv"):
    with open(folder / table, newline="") as file:
        return [{k: v for k, v in row.items() if k not in CLOCK} for row in csv.DictReader(file)]


def is_harmless(program, folder, name, wanted):
    """True if the change is refused, or the study gives its rows again. What is in origin.json is
    run as it stands there: the row is equal, or it is said what differs."""
    if name == "origin.json":
        found = run(program, folder, ["reproduce", "c/compare.csv:1", "-q"])
        return found.returncode == 0 or (found.returncode < 128 and found.stderr.count(b"\n") == 1)
    ended = run(program, folder, COMPARE)
    return ended.returncode == 4 or (ended.returncode == 0 and rows(folder) == wanted)


def try_bytes(program, work, name, stride, found_by_verify, is_right):
    """Changes bytes of a file of the folder "c", which lies whole in "whole"."""
    whole, wrong, unseen = (work / "whole" / name).read_bytes(), [], []
    places = range(min(len(name), len(whole) - 1) % stride, len(whole), stride)
    for at in places:
        shutil.rmtree(work / "c")
        shutil.copytree(work / "whole", work / "c")
        changed = bytearray(whole)
        changed[at] ^= 1 << at % 8
        (work / "c" / name).write_bytes(changed)
        if run(program, work, ["verify", "c", "-q"]).returncode not in found_by_verify:
            unseen.append(at)
        if not is_right():
            wrong.append(at)
    return (f"{len(places)} bytes, believed {wrong}, not seen by verify {unseen}",
            places and not wrong and not unseen)


def is_swept(program, work, wanted):
    shutil.rmtree(work / "s", ignore_errors=True)
    shutil.copytree(work / "c", work / "s")
    ended = run(program, work, SWEEP)
    return ended.returncode in (2, 4) or (ended.returncode == 0 and rows(work, "s/sweep.csv") == wanted)


def is_merged(program, work, wanted, last):
    """The parts are refused, or what is merged of them, and made whole, is that of before, but for
    the last row of a table that has lost its end: it counts as not written."""
    shutil.rmtree(work / "m", ignore_errors=True)
    ended = run(program, work, ["merge", "p", "c", "-o", "m", "-q"])
    if ended.returncode == 0 and last:
        ended = run(program, work, [*last, "-o", "m"])
    if ended.returncode:
        return ended.returncode in (2, 4)
    found, table = merged(work), work / "c" / "sweep.csv"
    cut = table.exists() and not table.read_bytes().endswith(b"\n")
    return wanted is not None and all(
        found[name] == wanted[name] or cut and name == "sweep.csv" and
        set(found[name].splitlines()) == set(wanted[name].splitlines()[:-1])
        for name in wanted)


def merged(work):
    """Tables and provenance of a merged folder; of a map its cells."""
    return {path.name: path.read_bytes() for path in sorted((work / "m").iterdir())
            if path.name in ("compare.csv", "origin.json", "sweep.csv", "rk4.csv")}


def lay(work, folder):
    for name in ("c", "whole"):
        shutil.rmtree(work / name, ignore_errors=True)
        shutil.copytree(work / folder, work / name)


def main():
    program, stride = str(pathlib.Path(sys.argv[1]).resolve()), int(sys.argv[2])
    work = pathlib.Path(tempfile.mkdtemp())
    (work / "a.json").write_text(SCENE)
    assert run(program, work, COMPARE).returncode == 0
    wanted = rows(work)
    shutil.copytree(work / "c", work / "whole")
    number = bad = 0

    def report(name, found):
        nonlocal number, bad
        number, bad = number + 1, bad + (not found[1])
        print(f"{'ok' if found[1] else 'not ok'} {number} - {name.split('-')[0]}: {found[0]}", flush=True)

    for name in ["compare.csv", "origin.json",
                 *sorted(path.name for path in (work / "whole").glob("reference-*.state"))]:
        report(name, try_bytes(program, work, name, stride, (1,),
                               lambda: is_harmless(program, work, name, wanted)))

    assert run(program, work, SWEEP).returncode == 0
    swept = rows(work, "s/sweep.csv")
    lay(work, "s")
    report("sweep.csv", try_bytes(program, work, "sweep.csv", stride, (1,),
                                  lambda: is_swept(program, work, swept)))
    report("manifest.txt", try_bytes(program, work, "manifest.txt", max(1, stride // 8), (4,),
                                     lambda: is_swept(program, work, swept)))

    # parts of a study, of which one is changed
    for command, names, last in ((COMPARE[:-2], ("compare.csv", "origin.json"), None),
                                 (SWEEP[:-2], ("sweep.csv",), None), (MAP, ("rk4.partial",), MAP)):
        for k in (1, 2):
            shutil.rmtree(work / f"p{k}", ignore_errors=True)
            part = [word.replace("rk4:dt=5e-3", "rk4:dt=5e-3,rk4:dt=2e-3") for word in command]
            assert run(program, work, [*part, "--shard", f"{k}/2", "-o", f"p{k}"]).returncode == 0
        shutil.rmtree(work / "p", ignore_errors=True)
        shutil.copytree(work / "p1", work / "p")
        lay(work, "p2")
        shutil.rmtree(work / "m", ignore_errors=True)
        assert is_merged(program, work, None, last) is False
        whole = merged(work)
        for name in names:
            # a part of a map is kilobytes a cell
            far = stride * (20 if name == "rk4.partial" else 4)
            report(f"merged {name}", try_bytes(program, work, name, far, (1,),
                                               lambda: is_merged(program, work, whole, last)))
    print(f"1..{number}")
    shutil.rmtree(work)
    return bad > 0


sys.exit(main())
