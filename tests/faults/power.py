#!/usr/bin/python3
"""Records what commands write, call by call, and loses power after each call: what is on the disk
then must do as docs/reliability.md promises (as TAP; needs strace).

usage: power.py PROGRAM STRIDE ORDERS    every STRIDE-th call; ORDERS random choices at each

Between two barriers the disk may have taken any of the calls. A barrier is fsync or fdatasync: of a
file it brings its bytes and its name to disk, as ext4, xfs and btrfs do; of a folder its names. A
write that is not behind a barrier may be there, be missing, be cut short, or have given the file
its length without its bytes. Names are made, moved and removed as a whole.
"""
import csv
import json
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile

sys.argv[1:] or sys.exit("usage: power.py PROGRAM STRIDE ORDERS")

CLOTH = {"cloth": {"grid": [4, 3]}, "mass": {"total": 0.1}, "springs": {"stretch": 40}, "pins": ["top"]}
SCENE = {"bodies": [CLOTH], "time": {"fps": 50}}
METHOD = "velocity-verlet:dt=2e-3"
RUN = ["run", "a.json", "-n", "7", "-i", METHOD, "--no-render", "-q", "--hash", "--monitor", "w.csv",
       "--ledger", "l.csv", "--export", "pc2,npz"]
COMPARE = ["compare", "a.json", "-i", "rk4:dt=5e-3,rk4:dt=2e-3", "--reference", "rk4:dt=1e-3",
           "--reference", "dopri5:rtol=1e-11,atol=1e-11", "-t", "0.04", "--runs", "1", "-q", "-o", "c"]
SWEEP = ["sweep", "a.json", "-s", "forces.drag=0,0.1", "-i", "rk4", "-n", "2", "-q", "-o", "s"]
CLOCK = {"cpu", "cpu_low", "cpu_high", "wall", "runs", "outliers", "check"}
CALLS = ("open,openat,creat,write,pwrite64,ftruncate,lseek,close,rename,renameat,renameat2,unlink,"
         "unlinkat,fsync,fdatasync,dup,dup2,dup3,fcntl,clone,clone3,fork,vfork")
LINE = re.compile(r"(\d+) +(\w+)\((.*)\) += (-?\d+|0x[0-9a-f]+)")


class File:
    """Bytes on disk for certain, and the calls since the last barrier."""
    def __init__(self):
        self.safe, self.calls = b"", []

    def bytes(self, calls):
        out = bytearray(self.safe)
        for at, data in calls:
            if data is None:
                del out[at:]
                out.extend(bytes(at - len(out)))
            else:
                out.extend(bytes(max(0, at + len(data) - len(out))))
                out[at:at + len(data)] = data
        return bytes(out)


class Disk:
    """Names on disk for certain, and changes of names since the last barrier."""
    def __init__(self):
        self.safe, self.changes = {}, []

    def now(self, changes):
        names = dict(self.safe)
        for removed, made, file in changes:
            names.pop(removed, None)
            if made:
                names[made] = file
        return names

    def change(self, removed, made, file):
        self.changes.append((removed, made, file))

    def sync_file(self, file):
        file.safe, file.calls = file.bytes(file.calls), []
        self.settle(lambda change: change[2] is file and change[0] is None)

    def sync_folder(self, folder):
        self.settle(lambda change: os.path.dirname(change[1] or change[0]) == folder)

    def settle(self, chosen):
        self.safe = self.now([change for change in self.changes if chosen(change)])
        self.changes = [change for change in self.changes if not chosen(change)]

    def states(self, orders, rng):
        """What may be found, as {name: bytes}: all, nothing, names without bytes, lengths without
        bytes, and random choices."""
        def image(changes, bytes_of):
            return {name: bytes_of(file) for name, file in self.now(changes).items()}

        def zeros(file):
            return file.safe + bytes(max(0, len(file.bytes(file.calls)) - len(file.safe)))

        def some(file):
            calls = file.calls[:rng.randint(0, len(file.calls))]
            if calls and calls[-1][1] and rng.random() < 0.5:
                at, data = calls[-1]
                calls[-1] = (at, data[:rng.randint(0, len(data))])
            return zeros(file) if rng.random() < 0.2 else file.bytes(calls)

        yield image(self.changes, lambda file: file.bytes(file.calls))
        yield image([], lambda file: file.safe)
        yield image(self.changes, lambda file: file.safe)
        yield image(self.changes, zeros)
        for _ in range(orders):
            yield image([change for change in self.changes if rng.random() < 0.5], some)


def texts(arguments):
    return [bytes.fromhex(text.replace("\\x", "")) for text in re.findall(r'"((?:\\x..)*)"', arguments)]


def record(program, folder, words):
    """Lines of strace, those of interrupted calls joined."""
    log = folder.parent / "calls"
    subprocess.run([shutil.which("strace"), "-f", "-qq", "-xx", "-s", "1000000000", "-e", "trace=?" + CALLS.replace(",", ",?"), "-o", log,
                    program, *words], cwd=folder, check=True, capture_output=True, timeout=1200,
                   env=dict(os.environ, PATH=""))
    waiting, lines = {}, []
    for line in open(log):
        process = line.split(maxsplit=1)[0]
        if line.endswith("<unfinished ...>\n"):
            waiting[process] = line[:-len("<unfinished ...>\n")]
            continue
        resumed = re.match(r"\d+ +<\.\.\. \w+ resumed>(.*)", line, re.S)
        lines.append(waiting.pop(process) + resumed[1] if resumed else line)
    return [match.groups() for match in map(LINE.match, lines) if match]


def play(calls, folder):
    """Yields the disk after each call that changes a file below the folder."""
    disk, tables, names = Disk(), {}, {}

    def inside(path):
        return os.path.relpath(os.path.join(folder, os.fsdecode(path)), folder)

    for process, call, arguments, result in calls:
        result = int(result, 0)
        table = tables.setdefault(process, next(iter(tables.values()), {}) if not tables else {})
        words = arguments.split(", ")
        if result < 0:
            continue
        if call in ("clone", "clone3", "fork", "vfork"):
            tables[str(result)] = table if "CLONE_FILES" in arguments else dict(table)
            continue
        number = int(words[0]) if words[0].isdigit() else -1
        if call in ("open", "openat", "creat"):
            path = inside(texts(arguments)[0])
            table.pop(result, None)
            if path.startswith("..") or os.path.isabs(path):
                continue
            if "O_DIRECTORY" in arguments:
                table[result] = [path if path != "." else "", None]
                continue
            made = path not in names
            if made and "O_CREAT" not in arguments:
                continue
            file = names.setdefault(path, File())
            table[result] = [file, 0]
            if made:
                disk.change(None, path, file)
            elif "O_TRUNC" in arguments:
                file.calls.append((0, None))
        elif call in ("rename", "renameat", "renameat2"):
            old, new = map(inside, texts(arguments))
            names[new] = names.pop(old)
            disk.change(old, new, names[new])
        elif call in ("unlink", "unlinkat"):
            path = inside(texts(arguments)[0])
            if names.pop(path, None):
                disk.change(path, None, None)
        elif number not in table:
            continue
        elif call == "close":
            del table[number]
            continue
        elif call in ("dup", "dup2", "dup3") or (call == "fcntl" and "F_DUPFD" in arguments):
            table[result] = table[number]
            continue
        elif call in ("fsync", "fdatasync"):
            of = table[number][0]
            disk.sync_file(of) if isinstance(of, File) else disk.sync_folder(of)
        elif call == "lseek":
            table[number][1] = result
            continue
        elif call == "ftruncate":
            table[number][0].calls.append((int(words[1]), None))
        elif call == "write":
            entry, data = table[number], texts(arguments)[0][:result]
            entry[0].calls.append((entry[1], data))
            entry[1] += len(data)
        elif call == "pwrite64":
            table[number][0].calls.append((int(words[-1]), texts(arguments)[0][:result]))
        else:
            continue
        yield disk


def lay(image, folder):
    for old in folder.iterdir():
        shutil.rmtree(old) if old.is_dir() else old.unlink()
    (folder / "a.json").write_text(json.dumps(SCENE))
    for name, data in image.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(data)


def clothsim(program, folder, words):
    return subprocess.run([program, *words], cwd=folder, capture_output=True, timeout=1200,
                          env=dict(os.environ, PATH=""))


def tree(folder, names):
    return {name: (folder / name).read_bytes() for name in names if (folder / name).exists()}


def refused(found):
    """One line and the code of a file."""
    return found.returncode == 4 and found.stderr.count(b"\n") == 1


class Run:
    """Once its first checkpoint is on disk, a run goes on to the end of the unbroken one."""
    words = [*RUN, "-o", "out", "--checkpoint", "2"]
    manifest, ends = "out", ["w.csv", "l.csv", "out/cloth.pc2", "out/a.npz"]

    def __init__(self, program, folder, found):
        self.hash = found.stdout
        exported = [f"out/{path.name}" for path in (folder / "out").iterdir()
                    if path.suffix in (".pc2", ".npz")]
        self.ends = tree(folder, ["w.csv", "l.csv", *exported])
        assert len(self.ends) == 4, self.ends.keys()

    def recover(self, program, folder, disk):
        there = (folder / "out/run.checkpoint").exists()
        found = clothsim(program, folder, [*RUN, "--resume", "out"] if there else
                         [*RUN, "-o", "out", "--checkpoint", "2", "-y"])
        promised = "out/run.checkpoint" in disk.safe or not there
        if found.returncode == 0 or promised:
            same = self.hash.endswith(found.stdout) and tree(folder, self.ends) == self.ends
            other = [name for name, data in tree(folder, self.ends).items() if data != self.ends[name]]
            return "" if found.returncode == 0 and same else \
                f"resume: {found.returncode} {found.stdout} {other} {found.stderr}"
        return "" if refused(found) else f"not refused: {found.returncode} {found.stderr}"


class Study:
    """Rows of a study are right, or refused; none is believed that was not written."""
    def __init__(self, program, folder, found):
        self.rows = self.read(folder)

    def read(self, folder):
        with open(folder / self.table, newline="") as file:
            return [{k: v for k, v in row.items() if k not in CLOCK} for row in csv.DictReader(file)]

    def recover(self, program, folder, disk):
        found = clothsim(program, folder, self.words)
        right = found.returncode == 0 and self.read(folder) == self.rows
        return "" if right or refused(found) else f"rows: {found.returncode} {found.stderr}"


class Compare(Study):
    words, manifest, table = COMPARE, "c", "c/compare.csv"


class Sweep(Study):
    words, manifest, table = SWEEP, "s", "s/sweep.csv"


def try_states(program, kind, stride, orders, folder):
    lay({}, folder)
    calls = record(program, folder, kind.words)
    whole = {path.name: path.read_bytes() for path in (folder / kind.manifest).iterdir()
             if path.is_file() and path.name[0] != "."}
    lay({}, folder)
    made = kind(program, folder, clothsim(program, folder, kind.words))
    rng, seen, wrong, n = random.Random(1), set(), [], 0
    for n, disk in enumerate(play(calls, folder), 1):
        for image in disk.states(orders, rng) if n % stride == 0 else ():
            mark = hash(tuple(sorted(image.items())))
            if mark in seen:
                continue
            seen.add(mark)
            lay(image, folder)
            signed = clothsim(program, folder, ["verify", kind.manifest]).returncode
            left = tree(folder / kind.manifest, whole) if signed == 0 else whole
            why = "" if left == whole else "verify finds nothing"
            why = why or made.recover(program, folder, disk)
            if why:
                wrong.append(f"after call {n}: {why}")
    return n, len(seen), wrong


def main():
    program, stride, orders = str(pathlib.Path(sys.argv[1]).resolve()), *map(int, sys.argv[2:4])
    bad = 0
    with tempfile.TemporaryDirectory() as work:
        folder = pathlib.Path(work) / "disk"
        folder.mkdir()
        for number, kind in enumerate((Run, Compare, Sweep), 1):
            n, states, wrong = try_states(program, kind, stride, orders, folder)
            bad += bool(wrong)
            print(f"{'not ok' if wrong else 'ok'} {number} - {kind.words[0]}: {states} states of the disk "
                  f"after {n} calls, {len(wrong)} wrong", flush=True)
            for text in wrong[:10]:
                print("#   " + text.replace("\n", " "))
    print("1..3")
    return bad > 0


sys.exit(main())
