#!/usr/bin/python3
"""kills.py PROGRAM FOLDER CELLS KILLS - eight processes share a sweep in one folder; one of them, drawn
at random, is killed at a random time and started again, KILLS times. The table in the end is that of
one process that nobody disturbed."""
import json
import random
import subprocess
import sys
import time
from pathlib import Path

sys.argv[1:] or sys.exit("usage: kills.py PROGRAM FOLDER CELLS KILLS")

PROCESSES = 8
program, folder, cells, kills = sys.argv[1], Path(sys.argv[2]), int(sys.argv[3]), int(sys.argv[4])
draw = random.Random(14)

scene = {"bodies": [{"cloth": {"grid": [4, 3]}, "mass": {"total": 0.1}, "springs": {"stretch": 40},
                     "pins": ["top"]}]}
(folder / "killed.json").write_text(json.dumps(scene))
side = max(1, round(cells ** 0.5))
study = [program, "sweep", str(folder / "killed.json"), "-i", "rk4", "-n", "10", "--quiet",
         "-s", "bodies[0].springs.stretch=" + ",".join(str(20 + k) for k in range(side)),
         "-s", "forces.drag=" + ",".join(str(k / 1000) for k in range(-(-cells // side)))]


def start(share):
    return subprocess.Popen(study + ["--shard", f"{share + 1}/{PROCESSES}", "-o", folder / "killed"])


begin = time.monotonic()
subprocess.run(study + ["-o", folder / "alone"], check=True)
alone = time.monotonic() - begin
running = [start(share) for share in range(PROCESSES)]
done = 0
while done < kills:
    # a fresh process needs its time to read the table: kills come while rows are written
    time.sleep(draw.uniform(0, 2 * alone / kills))
    share = draw.randrange(PROCESSES)
    done += running[share].poll() is None
    running[share].kill()
    running[share].wait()
    running[share] = start(share)
if any(process.wait() for process in running):
    sys.exit("# a process failed")
subprocess.run(study + ["-o", folder / "killed"], check=True)
sys.exit(subprocess.run([sys.executable, Path(__file__).parent / "same.py", folder / "alone/sweep.csv",
                         folder / "killed/sweep.csv"]).returncode)
