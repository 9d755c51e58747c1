#!/usr/bin/python3
"""Runs a command and sends it a signal as soon as a file is there and long enough, whatever the
load; ends with its code.

usage: stop_at.py SIGNAL FILE[:BYTES] COMMAND...
"""
import os
import signal
import subprocess
import sys
import time

sys.argv[1:] or sys.exit("usage: stop_at.py SIGNAL FILE[:BYTES] COMMAND...")


def is_due(path, size):
    return os.path.exists(path) and os.path.getsize(path) >= size


def main():
    path, _, size = sys.argv[2].partition(":")
    process = subprocess.Popen(sys.argv[3:])
    while process.poll() is None and not is_due(path, int(size or 0)):
        time.sleep(0.005)
    process.send_signal(getattr(signal, "SIG" + sys.argv[1]))
    code = process.wait()
    return code if code >= 0 else 128 - code


if __name__ == "__main__":
    sys.exit(main())
