#!/usr/bin/python3
"""usages.py ROOT - a tool that is started wrongly, or a test without its arguments, says in one line how it
is started (as TAP)."""
import subprocess
import sys
from pathlib import Path

sys.argv[1:] or sys.exit("usage: usages.py ROOT")

TOOLS = ("bench/validate.py", "tests/physics/random_scenes.py", "tools/contact_table.py",
         "tools/fitted_orders.py", "tools/make_walk.py")
# those that need none
WITHOUT = ("tests/tools/counts.py", "tests/tools/planted.py")
root = Path(sys.argv[1])
tests = [str(path.relative_to(root)) for path in sorted((root / "tests").rglob("*.py"))
         if path.read_text().startswith("#!") and str(path.relative_to(root)) not in TOOLS + WITHOUT]
bad = 0
for number, tool in enumerate([*TOOLS, *tests], 1):
    said = [subprocess.run([sys.executable, root / tool, *words], capture_output=True, text=True)
            for words in ((), ("no program", "x"))[:2 if tool in TOOLS else 1]]
    # argparse has its own form and status
    wrong = [p for p in said if p.returncode not in ((1,) if tool in TOOLS else (1, 2)) or p.stdout
             or (p.returncode == 1 and p.stderr.count("\n") != 1)
             or not p.stderr.startswith(f"usage: {Path(tool).name} ")]
    if any("No module named" in p.stderr for p in wrong):
        print(f"ok {number} # SKIP {tool}: a library is missing")
        continue
    bad += bool(wrong)
    print(f"{'not ' * bool(wrong)}ok {number} - {tool}")
    for p in wrong:
        print("# " + p.stderr.replace("\n", "\n# "))
print(f"1..{len(TOOLS) + len(tests)}")
sys.exit(bad > 0)
