#!/usr/bin/python3
"""progress_lines.py ROOT - what tests/progress.py makes of a meson that prints known lines: in a terminal
lines of tests that pass are left out, a file has all, the time left follows from the pace and has what comes
later in it, only tests below a limit are asked for, one more runs than there are processors, and the status
is meson's.
"""
import os
import pty
import subprocess
import sys
import tempfile
from pathlib import Path

import sources

sys.argv[1:] or sys.exit("usage: progress_lines.py ROOT")

MESON = """#!/bin/sh
case "$1 $4" in
    introspect*) echo '[{"name": "a", "priority": 300}, {"name": "b", "priority": 100}, {"name": "c d", "priority": 0},
                        {"name": "other", "priority": 1000}]' ;;
    *--list*) printf 'x:cli / a\\nx:cli / b\\nx:unit / c d\\n' ;;
    *) echo "$MESON_TESTTHREADS" >"${0%/*}/jobs"
       echo "ninja: $*"
       echo " 1/3 x:cli / b      OK               40.00s   2 subtests passed"
       echo " 2/3 x:unit / c d   FAIL              2.50s   exit status 1"
       echo "what it said"
       echo " 3/3 x:cli / a      EXPECTEDFAIL    120.00s"
       echo "Ok:  1"
       exit 3 ;;
esac
"""


def main():
    root, checks = Path(sys.argv[1]).resolve(), sources.Checks()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "meson")
        path.write_text(MESON)
        path.chmod(0o755)
        line = [root / "tests/progress.py", "build", "--suite", "cli"]
        env = {**os.environ, "PATH": f"{folder}:{os.environ['PATH']}", "PROGRESS_SECONDS": "0", "MESON_TESTTHREADS": "2",
               "LATER": "0", "SLOWER": "1"}
        ran = subprocess.run(line, capture_output=True, text=True, env=env)
        reader, terminal = pty.openpty()
        in_terminal = subprocess.run(line, stdout=subprocess.PIPE, stderr=terminal, text=True, env=env)
        below = subprocess.run([*line[:2], "--below", "100", *line[2:]], capture_output=True, text=True,
                               env={**env, "LATER": "1000", "SLOWER": "4"})
        subprocess.run(line, capture_output=True, env={name: env[name] for name in env if name != "MESON_TESTTHREADS"})
        jobs = int(Path(folder, "jobs").read_text())
        shown = [line.split()[0] for line in in_terminal.stdout.splitlines()]
        os.close(terminal), os.close(reader)
    checks.check(jobs == len(os.sched_getaffinity(0)) + 1, f"{jobs} tests at a time")
    checks.check(ran.returncode == 3, f"exit status {ran.returncode}, expected 3")
    out = ran.stdout.splitlines()
    checks.check([line.split()[0] for line in out] == ["ninja:", "1/3", "2/3", "what", "3/3", "Ok:"], f"printed {out}")
    checks.check(shown == ["ninja:", "2/3", "what", "Ok:"], f"shown {shown}")
    # 400.5 s of work at 40 s for 100, by two processors; then at 42.5 s for 100.5
    told = [line.replace(",", "").split() for line in ran.stderr.splitlines()]
    checks.check([(words[0], words[4]) for words in told] == [("1", "0"), ("2", "1"), ("3", "1")], f"progress {told}")
    checks.check(all(abs(float(words[7]) - left) < 20 for words, left in zip(told, (80, 85))), f"time left {told}")
    checks.check("after" in told[-1], f"end {told[-1]}")
    asked = below.stdout.splitlines()[0]
    checks.check(asked == "ninja: test -C build --suite cli c d", f"below 100 s it asked for {asked}")
    # expected were 6 s and, of tests that were not asked for, 3 s; 162.5 s it took: two processors for 1006 s at that pace
    words = below.stderr.splitlines()[-1].split()
    checks.check(words[7:] == ["151", "min", "left"], f"with what comes later {words}")
    return checks.end()


if __name__ == "__main__":
    sys.exit(main())
