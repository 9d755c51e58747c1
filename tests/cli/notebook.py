#!/usr/bin/python3
"""notebook.py PROGRAM NOTEBOOK... - runs the code of notebooks, cell by cell, without Jupyter (as TAP).

Their own assertions hold results against closed forms. A cell must end with a value that a notebook shows: a table,
numbers, or a picture. Outputs are cleared, so that a change of the program leaves no stale figure.
"""
import ast
import json
import os
import sys
import tempfile
import traceback
from pathlib import Path

sys.argv[1:] or sys.exit("usage: notebook.py PROGRAM NOTEBOOK...")

program, *notebooks = map(os.path.realpath, sys.argv[1:])
try:
    import numpy
except ImportError:
    print("1..0 # SKIP python3 has no numpy")
    sys.exit(0)
os.environ["CLOTHSIM"] = program
n = failed = 0


def told(name, problem):
    global n, failed
    n += 1
    failed += bool(problem)
    print(f"{'not ok' if problem else 'ok'} {n} - {name}")
    for line in problem.splitlines():
        print("#  ", line)


def run(source, names):
    """Runs a cell; returns the value of its last expression, None without one."""
    tree = ast.parse(source)
    last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, "cell", "exec"), names)
    return eval(compile(ast.Expression(last.value), "cell", "eval"), names) if last else None


def problem_of(cell, names):
    if cell["outputs"] or cell["execution_count"] is not None:
        return "has outputs"
    try:
        value = run("".join(cell["source"]), names)
    except Exception:  # pylint: disable=broad-exception-caught
        return traceback.format_exc()
    drawn = getattr(value, "_repr_png_", None)
    if drawn and drawn()[:8] != b"\x89PNG\r\n\x1a\n":
        return "ends with a picture that is no PNG"
    return "" if value is None or drawn or len(value) else "ends with an empty table"


for path in notebooks:
    sys.path.insert(0, os.path.dirname(path))
    book = json.loads(Path(path).read_text(encoding="utf-8"))
    told(f"{Path(path).name}: format 4, each cell with a name of its own",
         "" if book["nbformat"] == 4 and len({c["id"] for c in book["cells"]}) == len(book["cells"]) else "is not")
    names = {"__name__": "notebook"}
    with tempfile.TemporaryDirectory() as work:
        os.chdir(work)
        for cell in book["cells"]:
            if cell["cell_type"] == "code":
                told(f"{Path(path).name}: {cell['id']}", problem_of(cell, names))
        told(f"{Path(path).name} leaves no files", "\n".join(os.listdir(work)))
        os.chdir("/")
print(f"1..{n}")
sys.exit(failed > 0)
