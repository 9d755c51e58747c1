#!/usr/bin/python3
"""Holds clothsim-files(5), the schemas and clothsim.py to what the program writes (as TAP).

usage: files.py PROGRAM SCENES CLOTHSIM.PY
"""
import base64
import csv
import importlib.util
import json
import math
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import jsonschema
import numpy as np

sys.argv[1:] or sys.exit("usage: files.py PROGRAM SCENES CLOTHSIM.PY")

program, scenes, module_path = (str(Path(word).resolve()) for word in sys.argv[1:])
# keys that no run below can have: a machine with other arithmetic; more than a short test asks
UNSEEN = {"run.json": {"contact.other_body", "error.measured", "strain_limit_missed", "energy.other", "crossings.first",
                       "beyond_cloth", "untangle", "singular_force", "singular_force.time", "singular_force.particle",
                       "crossings.first.time", "crossings.first.edge", "crossings.most_at"},
          "compare.json": {key for at in ("verdict[]", "stable_at_frame_step") for key in
                           [at + ".by_" + norm for norm in "error path largest velocity energy".split()]}}

TINY = {"bodies": [{"cloth": {"grid": [4, 4], "size": [0.5, 0.5], "start": "flat", "stretch": [1.05, 1.05],
                              "bump": 0.05},
                    "mass": {"total": 0.1}, "pins": ["edges"],
                    "springs": {"stretch": 50, "shear": 20, "bend": 1, "damping": 0.01}}],
        "forces": {"gravity": [0, 0, -9.81]}}
DROP = {"bodies": [{"cloth": {"grid": [4, 4], "size": [0.5, 0.5], "start": "flat",
                              "place": {"translate": [0, 0.05, 0]}},
                    "mass": {"total": 0.1}, "springs": {"stretch": 50, "shear": 20, "bend": 1},
                    "self_contact": True}],
        "colliders": [{"floor": {"height": 0}}], "contact": {"law": "force"}, "crossings": "count",
        "forces": {"gravity": [0, -9.81, 0]}, "integrator": "rk4"}

n, failed = 0, 0


def told(name, *wrong):
    global n, failed
    n += 1
    wrong = [text for text in wrong if text]
    failed += bool(wrong)
    print(f"{'not ok' if wrong else 'ok'} {n} - {name}")
    for text in wrong:
        print("#   " + str(text).replace("\n", "\n#   "))


def clothsim(*words, code=0):
    done = subprocess.run([program, *map(str, words)], capture_output=True, text=True, check=False)
    if done.returncode != code:
        sys.exit(f"Bail out! {' '.join(map(str, words))}: code {done.returncode}: {done.stderr}")
    return done.stdout


def manual():
    """Keys and types by file, in their order, from the section FILES of the page."""
    files, name = {}, None
    for line in clothsim("--files").splitlines():
        if line.startswith("## "):
            name = line[3:]
            files[name] = {}
        found = re.match(r"\*(.*)\*: ([a-z01 ]*)", line)
        if found:
            files[name][found[1]] = found[2].strip()
    return files


def keys(value, path, found):
    """Paths of all members, but those of a scene."""
    for key, inner in value.items() if isinstance(value, dict) else ():
        found.add(f"{path}.{key}" if path else key)
        if key != "scene" or isinstance(inner, str):
            keys(inner, f"{path}.{key}" if path else key, found)
    for inner in value if isinstance(value, list) else ():
        keys(inner, path + "[]", found)
    return found


def check_json(name, documents, columns=()):
    schema = json.loads(clothsim("--schema", name))
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    wrong, seen = [], set()
    for document in documents:
        keys(document, "", seen)
        wrong += [f"{error.json_path}: {error.message[:200]}" for error in validator.iter_errors(document)]
    there = set(files[name]) | {"cells[]." + column for column in columns}
    told(f"{name}: every key that is written is in the page and in the schema", *wrong,
         *(f"not in the page: {key}" for key in sorted(seen - there)))
    told(f"{name}: every key of the page is written",
         *(f"not written: {key}" for key in sorted(there - seen - UNSEEN.get(name, set()))))


def check_installed():
    """The build has each schema as a file, to be installed."""
    refused = subprocess.run([program, "--schema"], capture_output=True, text=True).stderr
    names = refused.strip().split("expected one of ")[1].split(", ")
    told("each schema is built for installation", *(
        name for name in names if not (Path(program).parent / f"{name}.schema.json").exists()))


def check_csv(name, path, before=(), checked=False, extra=()):
    with open(path, newline="", encoding="utf-8") as file:
        names, *rows = csv.reader(file)
    expected = [*before, *files[name], *(["check"] if checked else [])]
    wrong = [] if [column for column in names if column not in extra] == expected else [
        f"columns {names}\nof the page {expected}"]
    for row in rows:
        if len(row) != len(names):
            wrong.append(f"{len(row)} fields: {row}")
        for column, field in zip(names, row):
            kind = files[name].get(column, "text")
            if kind == "number" and field and not math.isfinite(float(field)):
                wrong.append(f"{column}: {field}")
            if kind == "0 or 1" and field not in ("0", "1"):
                wrong.append(f"{column}: {field}")
    told(f"{name}: columns are those of the page, in their order", *wrong, "" if rows else "no rows")
    return names, rows


def check_report(folder):
    """compare.html and compare.md: every row whole, short options, the pictures as they were written, one bar."""
    page = (folder / "compare.html").read_text(encoding="utf-8")
    text = (folder / "compare.md").read_text(encoding="utf-8")
    with open(folder / "compare.csv", newline="", encoding="utf-8") as file:
        cells = list(csv.DictReader(file))
    tables = [re.findall(r"<tr[^>]*>(.*?)</tr>", table, re.S)
              for table in re.findall(r"<table>(.*?)</table>", page, re.S)]
    (rows,) = tables
    balance = re.search(r"<h2>Energy balance</h2>\s*<pre>(.*?)\s*</pre>", page, re.S).group(1).split("\n")
    options = [re.findall(r"<td>(.*?)</td>", row)[1] for row in rows[1:]]
    short = [",".join(f"{key}={float(value):.6g}" for key, value in
                      (pair.split("=") for pair in cell["options"].split(","))) for cell in cells]
    told("compare.html: a whole row for each cell, with short options",
         "" if {len(re.findall("<t[dh][ >]", row)) for row in rows} == {14} else "rows of other lengths",
         "" if len(balance) == len(rows) else f"balance: {balance}",
         "" if options == short else f"options {options}\nexpected {short}")
    pictures = {base64.b64decode(data) for data in re.findall('src="data:image/png;base64,([^"]*)"', page)}
    files_drawn = {path.read_bytes() for path in (folder / "pictures").glob("equal_*.png")}
    told("compare.html: the pictures themselves, one colour bar, no link",
         "" if pictures == files_drawn and len(pictures) > 1 else f"{len(pictures)} pictures of {len(files_drawn)}",
         "" if page.count('class="bar"') == 1 else "bars", "" if " href=" not in page else "a link")
    linked = set(re.findall(r"!\[\]\(pictures/([^)]*)\)", text))
    told("compare.md: the pictures that are there",
         "" if linked == {path.name for path in (folder / "pictures").glob("equal_*.png")} and linked
         else f"{len(linked)} pictures linked")


def python(folder, compared):
    os.environ["CLOTHSIM"] = program
    spec = importlib.util.spec_from_file_location("clothsim", module_path)
    module = importlib.util.module_from_spec(spec)
    sys.modules["clothsim"] = module
    spec.loader.exec_module(module)
    types = files["compare.csv"]
    told("clothsim.py knows the types of all columns",
         "" if module.TEXTS == {name for name in types if types[name] == "text"} else "TEXTS differ",
         "" if module.FLAGS == {name for name in types if types[name] == "0 or 1"} else "FLAGS differ")
    names, rows = compared
    table = module.load_compare(folder / "compare")
    told("load_compare has every field of compare.csv",
         "" if list(table) == names[:-1] else "columns differ",
         *(f"{name} differs" for k, name in enumerate(names[:-1]) for row, value in zip(rows, table[name])
           if not (str(value) == row[k] if name in module.TEXTS else value == (row[k] == "1")
                   if name in module.FLAGS else np.isnan(value) if not row[k] else value == float(row[k]))))
    states = module.load_run(folder / "states")
    sought = {"integrator": "rk4:dt=0.001", "frames": 3, "set": {"forces.drag": 0.01, "time.fps": 50}}
    run = module.run(TINY, folder=folder / "python", **sought)
    again = module.load_run(folder / "python")
    by_hand = clothsim("run", folder / "tiny.json", "-n", 3, "--no-render", "--hash", "-q", "-i", "rk4:dt=0.001",
                       "-s", "forces.drag=0.01", "-s", "time.fps=50").split()
    told("run and load_run give the states of the same run by hand",
         "" if run.report["state_hash"] == by_hand[-1] else "hash differs",
         "" if np.array_equal(run.x, again.x) and np.array_equal(run.v, again.v) else "states differ",
         "" if run.x.shape == (4, 16, 3) and run.faces.shape == (18, 3) else "shapes differ",
         "" if np.allclose(run.times, np.arange(4) / 50, rtol=1e-12, atol=0) else f"times {run.times}",
         "" if states.x.shape == (3, 16, 3) and states.faces is None else "states have another shape",
         "" if np.array_equal(states.x[0], run.x[0]) else "start differs",
         "" if np.allclose(states.times, np.arange(3) / 60, rtol=1e-12, atol=0) else f"times {states.times}")
    message = ""
    try:
        module.run(TINY, set={"forces.drga": 1})
    except RuntimeError as error:
        message = str(error)
    told("run raises what the program says", "" if "forces.drga" in message else f"raised: {message}")
    python_tables(module, folder)


def python_tables(module, folder):
    """Tables of the studies beside what the program prints itself, without pandas and with a stand-in for it."""
    sys.modules["pandas"] = None
    reference = ("--reference", "rk4:dt=0.0001", "--reference", "dopri5:rtol=1e-10,atol=1e-10", "--runs", 1)
    steps = module.compare(TINY, ["rk4:dt=0.0005..0.001", "symplectic-euler:dt=0.001"], {"time.fps": 1000}, 0.004,
                           folder / "by_python", reference)
    errors = [row["error"] for row in steps if row["method"] == "rk4"]
    told("compare has a row a step, of errors that fall with order 4",
         "" if len(steps) >= 3 and {row["outcome"] for row in steps} == {"finished"} else f"{steps}",
         "" if len(errors) >= 2 and 8 < errors[0] / errors[1] < 32 else f"errors {errors}")
    advice = module.advise(TINY, ["velocity-verlet", "shape-matching"], seconds=0.1)
    told("advise has the step below the limit, and why a method has none",
         "" if 0 < advice[0]["advised"] < advice[0]["limit"] else f"{advice[0]}",
         "" if advice[1]["kind"] == "refused" and "shape_matching" in advice[1]["message"] else f"{advice[1]}")
    cells = module.stability(TINY, "velocity-verlet", seconds=0.05, options=("--stiffness", "50..50", "--columns", 1, "--rows", 3))
    told("stability has a row a cell, unstable above the limit alone",
         "" if len(cells) == 3 and cells[0]["dt"] < advice[0]["advised"] < cells[2]["dt"] else f"{cells}",
         *(f"{row}" for row in cells if ("instability" in row["verdict"]) != (row["dt"] > advice[0]["limit"])))
    (claim,) = module.conform("rk4", ["order"])
    told("conform has a row a check", "" if claim["verdict"] == "pass" and claim["figure"] < claim["bound"] else f"{claim}")
    small = {"render.size": [64, 48]}
    start, later = module.picture(TINY, set=small), module.picture(TINY, 3, small, "rk4")
    told("picture is a PNG of the size that a notebook shows",
         *("" if shown[:8] == b"\x89PNG\r\n\x1a\n" and shown[16:24] == bytes((0, 0, 0, 64, 0, 0, 0, 48))
           else "no PNG of 64 x 48" for shown in (start._repr_png_(), later._repr_png_())),
         "" if start.png != later.png else "nothing moved")
    sys.modules["pandas"] = type(sys)("pandas")
    sys.modules["pandas"].DataFrame = tuple
    told("a table is pandas' where it is there",
         "" if module.conform("rk4", ["abi"])[0]["check"] == "abi" and
         isinstance(module.conform("rk4", ["abi"]), tuple) else "it is not")
    del sys.modules["pandas"]


files = manual()
sundials_is_absent = "ark-erk" not in clothsim("integrators")
if sundials_is_absent:
    UNSEEN["run.json"].add("restarted_every")
with tempfile.TemporaryDirectory() as work:
    os.chdir(work)
    here = Path(work)
    for name, scene in ("tiny", TINY), ("drop", DROP):
        Path(name + ".json").write_text(json.dumps(scene), encoding="utf-8")

    clothsim("run", "tiny.json", "-n", 2, "-o", "drawn", "-q", "--timing", "-s", "render.look=strain", "-s",
             "render.size=[64,48]", "--renderer", "cpu", "--monitor", "monitor.csv", "--ledger",
             "ledger.csv")
    clothsim("run", "tiny.json", "-n", 2, "--no-render", "-q", "--states", "states", "--json", "states.json")
    Path("states.json").rename("states/run.json")
    clothsim("run", "tiny.json", "-n", 60, "--no-render", "-q", "--json", "blown.json", "-i", "explicit-euler:dt=0.01")
    for k, words in enumerate((("-i", "ark-erk", "-o", "kept", "--checkpoint", 2),
                               ("-s", "bodies[0].self_contact=false"))[sundials_is_absent:]):
        clothsim("run", "drop.json", "-n", 3, "--no-render", "-q", "--json", f"drop{k}.json", *words)
    check_json("run.json", [json.loads(Path(path).read_text(encoding="utf-8")) for path in
                            ("drawn/run.json", "states/run.json", "blown.json", *map(str, here.glob("drop[01].json")))])
    check_csv("monitor.csv", "monitor.csv")
    check_csv("ledger.csv", "ledger.csv", extra=("membrane", "bending", "membrane_work", "bending_work"))

    # frames so short that every method is stable at one step a frame
    clothsim("compare", "tiny.json", "-i", "symplectic-euler:dt=0.000125..0.001,rk4:dt=0.00025..0.001", "-s", "time.fps=1000",
             "-t", 0.02, "--runs", 3, "-q", "--ledger", "-o", "compare", "--pictures", "--report", "--renderer", "cpu")
    check_report(Path("compare"))
    compared = check_csv("compare.csv", "compare/compare.csv", checked=True)
    check_json("compare.json", [json.loads(Path("compare/compare.json").read_text(encoding="utf-8"))],
               files["compare.csv"])

    clothsim("compare", "tiny.json", "-i", "rk4:dt=0.001", "-s", "time.fps=1000", "-n", 2, "--runs", 1, "-q", "-o", "named",
             "--reference", "rk4:dt=0.0001", "--reference", "dopri5:rtol=1e-10,atol=1e-10")
    clothsim("sweep", "tiny.json", "-s", "forces.drag=0,0.01", "-i", "rk4", "-n", 2, "-q", "-o", "sweep")
    check_csv("sweep.csv", "sweep/sweep.csv", before=("cell", "forces.drag"), checked=True)

    clothsim("stability", "tiny.json", "-i", "velocity-verlet", "--columns", 2, "--rows", 2, "-t", 0.05, "-q", "-o",
             "map")
    check_csv("stability.csv", "map/velocity-verlet.csv", before=("stiffness",))
    check_csv("stability_border.csv", "map/velocity-verlet_border.csv", before=("stiffness",))
    check_json("stability.json", [json.loads(Path("map/velocity-verlet.json").read_text(encoding="utf-8"))])
    clothsim("stability", "--extreme", "all_pinned", "-i", "rk4", "--folder", scenes + "/extreme", "--json", "x.json", "-q")
    check_json("extreme.json", [json.loads(Path("x.json").read_text(encoding="utf-8"))])
    check_json("origin.json", [json.loads(Path(folder, "origin.json").read_text(encoding="utf-8"))
                               for folder in ("compare", "named")])
    clothsim("advise", "tiny.json", "-i", "velocity-verlet,dopri5", "-t", 0.02, "--json", "a.json", "-q")
    check_json("advise.json", [json.loads(Path("a.json").read_text(encoding="utf-8"))])
    clothsim("conform", "rk4", "--only", "momentum", "--json", "c.json", "-q")
    check_json("conform.json", [json.loads(Path("c.json").read_text(encoding="utf-8"))])
    clothsim("golden", "--add", "tiny.json", "-n", 1, "--folder", "golden")
    clothsim("golden", "--hashes", "--folder", "golden", "--json", "g.json", "-q")
    check_json("golden.json", [json.loads(Path("g.json").read_text(encoding="utf-8"))])
    clothsim("integrators", "--json", "i.json")
    check_json("integrators.json", [json.loads(Path("i.json").read_text(encoding="utf-8"))])
    clothsim("scene", "tiny.json", "--json", "s.json")
    check_json("check.json", [json.loads(Path("s.json").read_text(encoding="utf-8"))])
    check_installed()
    python(here, compared)
    os.chdir("/")
missing = set(files) - {"run.json", "monitor.csv", "ledger.csv", "compare.csv", "compare.json", "sweep.csv", "stability.csv",
                        "stability_border.csv", "stability.json", "extreme.json", "conform.json", "golden.json",
                        "advise.json", "origin.json", "integrators.json", "check.json"}
told("every file of the page is looked at above", *sorted(missing))
print(f"1..{n}")
sys.exit(failed > 0)
