#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""progress.py BUILD [--below S] [ARGUMENT ...] - meson test with these arguments, and on standard error the
progress with the time left. A terminal has no lines of tests that pass; a file, as of CI, has all lines.
--below: of the tests that they choose those of fewer than S s. In the environment, LATER is the processor time
in s of what comes after these tests, SLOWER how often theirs a build with a sanitizer takes.

The priority of a test is about its processor time in s (tests/meson.build): the longest start first. Tests
that have ended tell how much longer a second of it takes here. One test more than there are processors
runs at a time, for some wait. A terminal has one line, anything else a line every half minute. The exit
status is meson's.
"""
import json
import math
import os
import re
import subprocess
import sys
import time

sys.argv[1:] or sys.exit("usage: progress.py BUILD [--below S] [ARGUMENT ...]")

LEAST = 1.5  # s of a test without a priority: about their mean
LINE = re.compile(r"\s*(\d+)/(\d+) (?:.*? / )?(.+?)\s+([A-Z]{2,})\s+([\d.]+)s\b")
PASSED = {"OK", "EXPECTEDFAIL", "SKIP"}


def seconds_of(build, arguments, below):
    """The expected seconds of each test that these arguments choose, if they are fewer than so many."""
    priorities = {test["name"]: test["priority"] for test in
                  json.loads(subprocess.check_output(["meson", "introspect", build, "--tests"]))}
    listed = subprocess.run(["meson", "test", "-C", build, "--list", "--no-rebuild", *arguments], stdout=subprocess.PIPE,
                            stderr=subprocess.DEVNULL, text=True).stdout
    names = [line.rsplit(" / ", 1)[-1] for line in listed.splitlines()]
    slower = float(os.environ.get("SLOWER", 1))
    return {name: slower * max(priorities[name], LEAST) for name in names
            if name in priorities and priorities[name] < below}


class Progress:
    def __init__(self, seconds, jobs):
        self.seconds, self.jobs, self.start = seconds, jobs, time.monotonic()
        self.expected = self.took = 0.0  # s of tests that have ended
        self.failed, self.terminal, self.told = 0, sys.stderr.isatty(), time.monotonic()
        self.later = float(os.environ.get("LATER", 0))

    def left(self, elapsed):
        """s: the rest of all, at the pace of what has ended, on so many processors."""
        pace = self.took / self.expected if self.expected else 1
        return max(0, sum(self.seconds.values()) * pace / self.jobs - elapsed) + self.later * pace / self.jobs

    def show(self, done, whole):
        now = time.monotonic()
        elapsed = now - self.start
        left = self.left(elapsed)
        about = f"{left / 60:.0f} min" if left > 90 else f"{left:.0f} s"
        line = f"{done} of {whole} tests, {self.failed} failed, " + \
            (f"after {elapsed:.0f} s" if done == whole and not self.later else f"about {about} left")
        if self.terminal:
            print(f"\r{line}\033[K", end="", file=sys.stderr, flush=True)
        elif now - self.told >= float(os.environ.get("PROGRESS_SECONDS", 30)) or done == whole:
            print(line, file=sys.stderr, flush=True)
            self.told = now

    def clear(self):
        if self.terminal:
            print("\r\033[K", end="", file=sys.stderr, flush=True)

    def end_of(self, name, verdict, took):
        self.expected += self.seconds.get(name, LEAST)
        self.took += took
        self.failed += verdict not in PASSED


def main():
    build, *arguments = sys.argv[1:]
    below = math.inf
    if arguments[:1] == ["--below"]:
        below, arguments = float(arguments[1]), arguments[2:]
    jobs = int(os.environ.get("MESON_TESTTHREADS", 0)) or len(os.sched_getaffinity(0)) + 1
    seconds = seconds_of(build, [word for word in arguments if word != "--print-errorlogs"], below)
    progress = Progress(seconds, jobs)
    arguments += [] if math.isinf(below) else seconds
    meson = subprocess.Popen(["meson", "test", "-C", build, *arguments], stdout=subprocess.PIPE, text=True,
                             errors="replace", env={**os.environ, "MESON_TESTTHREADS": str(jobs)})
    for line in meson.stdout:
        found = LINE.match(line)
        if not found or found[4] not in PASSED or not progress.terminal:
            progress.clear()
            print(line, end="", flush=True)
        if found:
            progress.end_of(found[3], found[4], float(found[5]))
            progress.show(int(found[1]), int(found[2]))
    progress.clear()
    return meson.wait()


if __name__ == "__main__":
    sys.exit(main())
