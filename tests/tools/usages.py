#!/usr/bin/python3
"""usages.py ROOT - a tool that is started wrongly says in one line how it is started (as TAP)."""
import subprocess
import sys
from pathlib import Path

TOOLS = ("bench/validate.py", "tests/physics/random_scenes.py", "tools/contact_table.py",
         "tools/fitted_orders.py", "tools/make_walk.py")
root = Path(sys.argv[1])
bad = 0
for number, tool in enumerate(TOOLS, 1):
    said = [subprocess.run([sys.executable, root / tool, *words], capture_output=True, text=True)
            for words in ((), ("no program", "x"))]
    wrong = [p for p in said if p.returncode != 1 or p.stdout or p.stderr.count("\n") != 1
             or not p.stderr.startswith(f"usage: {Path(tool).name} ")]
    if any("No module named" in p.stderr for p in wrong):
        print(f"ok {number} # SKIP {tool}: a library is missing")
        continue
    bad += bool(wrong)
    print(f"{'not ' * bool(wrong)}ok {number} - {tool}")
    for p in wrong:
        print("# " + p.stderr.replace("\n", "\n# "))
print(f"1..{len(TOOLS)}")
sys.exit(bad > 0)
