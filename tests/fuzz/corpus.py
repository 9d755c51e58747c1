#!/usr/bin/python3
"""The kept inputs of a fuzz target: a line each, in hexadecimal digits, few and short.

usage: corpus.py unpack LIST FOLDER
       corpus.py pack PROGRAM FOLDER LIST     those of a folder that reach most, by the fuzzer itself
"""
import hashlib
import os
import subprocess
import sys
import tempfile

sys.argv[1:] or sys.exit("usage: corpus.py unpack LIST FOLDER")

MOST, BYTES = 60, 400


def unpack(kept, folder):
    os.makedirs(folder, exist_ok=True)
    for line in open(kept):
        data = bytes.fromhex(line)
        with open(os.path.join(folder, hashlib.sha1(data).hexdigest()), "wb") as file:
            file.write(data)


def features(program, folder):
    """What each file of a folder reaches, as the fuzzer's own record of a merge says."""
    with tempfile.TemporaryDirectory() as work:
        record = os.path.join(work, "record")
        os.mkdir(os.path.join(work, "merged"))
        subprocess.run([program, "-merge=1", "-timeout=60", f"-max_len={BYTES}",
                        "-merge_control_file=" + record, os.path.join(work, "merged"), folder],
                       check=True, stderr=subprocess.DEVNULL)
        lines = open(record).read().splitlines()
    files = lines[2:2 + int(lines[0])]
    reached = {}
    for line in lines[2 + len(files):]:
        words = line.split()
        if words[0] == "FT":
            reached.setdefault(files[int(words[1])], set()).update(words[2:])
    return reached


def pack(program, folder, kept):
    """The one that adds most, until there are enough of them."""
    reached = {file: found for file, found in features(program, folder).items()
               if os.path.getsize(file) <= BYTES}
    chosen, known = [], set()
    while reached and len(chosen) < MOST:
        best = max(sorted(reached), key=lambda file: len(reached[file] - known))
        if not reached[best] - known:
            break
        known |= reached.pop(best)
        chosen.append(open(best, "rb").read())
    with open(kept, "w") as file:
        file.writelines(data.hex() + "\n" for data in sorted(chosen))


if __name__ == "__main__":
    {"pack": pack, "unpack": unpack}[sys.argv[1]](*sys.argv[2:])
