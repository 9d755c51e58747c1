#!/usr/bin/python3
"""terminal.py PROGRAM [--accept]: what --show draws, in a terminal of this test's own (as TAP).

Views are held to terminal/views.txt, in which \\e is the escape character, and to what follows from
the files that they show. --accept writes that file anew.
"""
import base64
import ctypes.util
import fcntl
import json
import os
import pty
import re
import select
import struct
import subprocess
import sys
import tempfile
import termios
import zlib
from pathlib import Path

import numpy as np

sys.argv[1:] or sys.exit("usage: terminal.py PROGRAM [--accept]")

PROGRAM = str(Path(sys.argv[1]).resolve())
HERE = Path(__file__).resolve().parent / "terminal"
TRUE_COLOUR, COLOURS_256, PLAIN = {"COLORTERM": "truecolor"}, {"COLORTERM": ""}, {"NO_COLOR": "1"}
# the terminal's answers: neither, kitty's protocol, sixel
CHARACTERS, KITTY, SIXEL = b"\033[?62;22c", b"\033_Gi=31;OK\033\\\033[?62;4c", b"\033[?62;4;22c"
QUESTION = b"\033_Gi=31,s=1,v=1,a=q,t=d,f=24;AAAA\033\\\033[c"

SCENE = {"bodies": [{"cloth": {"grid": [5, 4], "size": [0.8, 0.6]}, "mass": {"total": 0.2},
                     "pins": ["top"]}],
         "integrator": {"name": "rk4", "dt": 1e-3},
         "render": {"size": [80, 20]}}


def show(words, size, colours, answer=CHARACTERS):
    """Exit code and output of a command in a window of (columns, rows)."""
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", size[1], size[0], 0, 0))
    # the answer waits for the question: no load can make it late
    settings = termios.tcgetattr(theirs)
    settings[3] &= ~termios.ECHO
    termios.tcsetattr(theirs, termios.TCSANOW, settings)
    os.write(ours, answer)
    before = termios.tcgetattr(theirs)
    env = {k: v for k, v in os.environ.items() if k not in ("NO_COLOR", "COLORTERM")}

    def begin():
        os.setsid()
        fcntl.ioctl(theirs, termios.TIOCSCTTY, 0)

    process = subprocess.Popen([PROGRAM, *words], stdin=subprocess.DEVNULL, stdout=theirs, stderr=theirs,
                               env={**env, "TERM": "xterm", **colours}, preexec_fn=begin)
    out = b""
    while True:
        running = process.poll() is None
        part = os.read(ours, 65536) if select.select([ours], [], [], 0.05)[0] else b""
        out += part
        if not part and not running:
            break
    after = termios.tcgetattr(theirs)
    os.close(theirs)
    os.close(ours)
    check(before == after, f"{' '.join(words)}: the terminal's settings are as before")
    return process.returncode, out.replace(QUESTION, b"").replace(b"\r\n", b"\n").decode()


n = failed = 0
views = {}


def check(held, title):
    global n, failed
    n += 1
    failed += not held
    print("ok" if held else "not ok", n, "-", title)


def plain(text):
    return re.sub(r"\033\[[0-9;]*[A-Za-z]|\033[78]", "", text)


def view(name, words, size, colours):
    """A view for views.txt, which must fit the window."""
    code, text = show(words, size, colours)
    last = re.split(r"\033\[\d+A\r", text)[-1]
    views[name] = last
    check(code == 0, f"{name}: exit code {code}")
    check(all(len(line) <= size[0] for line in plain(last).split("\n")), f"{name}: {size[0]} columns")
    if colours is PLAIN:
        check("\033[3" not in text and "\033[4" not in text, f"{name}: without colour")
    return plain(last)


def read_png(path):
    """Pixels of a PNG of 8-bit RGB."""
    data, at, packed = path.read_bytes(), 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, height = struct.unpack(">II", body[:8])
        if kind == b"IDAT":
            packed += body
        at += length + 12
    rows = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(height, -1)
    pixels = np.zeros((height, width, 3), np.uint8)
    for y, row in enumerate(rows):
        assert row[0] == 1  # filter Sub: differences from the left
        pixels[y] = np.cumsum(row[1:].reshape(width, 3), axis=0, dtype=np.uint8)
    return pixels


def halved(pixels):
    """Means of 2 x 2 pixels, of linear light (IEC 61966-2-1)."""
    c = pixels / 255.0
    light = np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
    mean = (light[::2, ::2] + light[::2, 1::2] + light[1::2, ::2] + light[1::2, 1::2]) / 4
    return np.rint(255 * np.where(mean <= 0.0031308, 12.92 * mean, 1.055 * mean ** (1 / 2.4) - 0.055))


def blocks(text):
    """Pixels of half blocks in 24-bit colours."""
    rows, ink, paper = [], None, None
    for line in text.split("\n"):
        pairs = []
        for m in re.finditer(r"\033\[([34])8;2;(\d+);(\d+);(\d+)m|\033\[0m|▀", line):
            if m.group(1):
                colour = [int(c) for c in m.groups()[1:]]
                ink, paper = (colour, paper) if m.group(1) == "3" else (ink, colour)
            elif m.group() == "▀":
                pairs.append((ink, paper))
        if pairs:
            rows += [[p[0] for p in pairs], [p[1] for p in pairs]]
    return np.array(rows)


def test_pictures():
    Path("a.json").write_text(json.dumps(SCENE))
    first = view("run --show, 40 columns, 24 bit",
                 ["run", "a.json", "-n", "12", "--every", "4", "--show", "-q"], (40, 12), TRUE_COLOUR)
    check("frame 12 of 12, 0.2 s" in first, "run --show: the caption of the last frame")
    play = ["film", "out", "--show", "--fps", "1000"]
    for columns in (40, 80, 200):
        view(f"film --show, {columns} columns, 256 colours", play, (columns, 12), COLOURS_256)
        last = view(f"film --show, {columns} columns, no colour", play, (columns, 12), PLAIN)
        check("picture 3 of 3, 0.2 s" in last, "film --show ends at the last picture")
    pixels = read_png(Path("out/frame_00003.png"))
    code, text = show(play, (40, 12), TRUE_COLOUR)
    found = blocks(re.split(r"\033\[\d+A\r", text)[-1])
    expected = halved(pixels)
    check(found.shape == expected.shape and np.abs(found - expected).max() <= 1,
          "half blocks are the mean light of the picture")
    code, text = show(play, (200, 60), TRUE_COLOUR, KITTY)
    pieces = re.findall(r"\033_G([^;]*);([^\033]*)\033\\", text)
    start = [k for k, (keys, _) in enumerate(pieces) if "a=T" in keys][-1]
    data = b"".join(base64.b64decode(piece) for _, piece in pieces[start:])
    check(data == pixels.tobytes() and "s=80,v=20," in pieces[start][0],
          "kitty's protocol carries the pixels")
    check(all(len(piece) <= 4096 for _, piece in pieces), "in pieces of at most 4096 bytes")
    code, text = show(play, (80, 24), TRUE_COLOUR, SIXEL)
    if ctypes.util.find_library("sixel"):
        check("\033Pq" in text, "sixel by libsixel")
    else:
        check("install the Debian package libsixel1" in text and "▀" in text, "no libsixel: it says so")
    code, text = show(play, (80, 24), {**TRUE_COLOUR, **PLAIN}, KITTY)
    check("\033_G" not in text and "\033[3" not in text, "NO_COLOR: characters alone")


def front():
    """Cells of the CSV than which nothing is both cheaper and more accurate."""
    import csv
    rows = [row for row in csv.DictReader((HERE / "compare.csv").open()) if row["outcome"] == "finished"]
    points = [(float(row["work"]), float(row["error"])) for row in rows]
    return [p for p in points if not any(q != p and q[0] <= p[0] and q[1] <= p[1] for q in points)]


def test_diagram():
    words = ["plot", str(HERE / "compare.csv"), "--show", "--x", "work", "--title", "two words"]
    texts = {}
    for columns in (40, 80, 200):
        texts[columns] = view(f"plot --show, {columns} columns, no colour", words, (columns, 24), PLAIN)
        view(f"plot --show, {columns} columns, 24 bit", words, (columns, 24), TRUE_COLOUR)
        drawn = [line[8:] for line in texts[columns].split("\n") if re.match(r" *[0-9e-]*[|+]", line)]
        check(len(texts[columns].rstrip().split("\n")) < 24, f"{columns} columns: in the window's height")
        capitals = sum(c.isupper() for line in drawn for c in line)
        check(capitals == len(front()), f"{columns} columns: {len(front())} cells on the front")
        check(any("x" in line for line in drawn) and any("O" in line for line in drawn),
              f"{columns} columns: a failed cell, one with crossings on the front")
    words = {columns: re.split(r"[ \n]+", text) for columns, text in texts.items()}
    key = [word for word in words[200] if word.isalpha() and len(word) > 2]
    check(len(key) > 20 and all(word in words[40] for word in key), "no word is cut at 40 columns")
    check(not list(Path().glob("error_work.*")), "plot --show writes no file")
    head = (HERE / "compare.csv").read_text().split("\n")[0]
    Path("empty.csv").write_text(head + "\n")
    code, text = show(["plot", "empty.csv", "--show"], (80, 24), PLAIN)
    check(code == 4 and "no rows below names of columns" in text, "a comparison without cells")


def test_map():
    for columns in (40, 80, 200):
        for name, colours in (("no colour", PLAIN), ("24 bit", TRUE_COLOUR), ("256 colours", COLOURS_256)):
            words = ["stability", "a.json", "-i", "velocity-verlet", "--columns", "4", "--rows", "6",
                     "--stiffness", "10..10000", "--dt", "1e-4..1e-1", "-t", "0.05", "-q", "-y",
                     "--show", "-o", f"map{columns}{name[0]}"]
            text = view(f"stability --show, {columns} columns, {name}", words, (columns, 24), colours)
            if colours is PLAIN:
                rows = Path(f"map{columns}n/velocity-verlet.csv").read_text().split("\n")[1:-1]
                bounded = sum(row.split(",")[2] == "bounded" for row in rows)
                drawn = [line[8:] for line in text.split("\n") if re.match(r" *[0-9.e-]*[|+]", line)]
                check(bounded > 0 and sum(line.count(".") for line in drawn) == bounded,
                      f"{columns} columns: {bounded} bounded cells")


def test_compare():
    code, text = show(["compare", "a.json", "-i", "rk4:dt=1e-3..4e-3,symplectic-euler:dt=5e-4..2e-3", "-t",
                       "0.1", "-o", "c", "--runs", "1", "-q", "--show"], (60, 24), PLAIN)
    check(code == 0 and "right: work in passes" in text and Path("c/compare.csv").exists(),
          "compare --show: the diagram, beside its files")
    check(all(letter in text for letter in ("a rk4", "b symplectic-euler")), "and its letters")


def test_words():
    """Reports wrap at words in a narrow window, with the words of a wide one."""
    comparison = ["compare", "a.json", "-i", "rk4:dt=1e-3..4e-3,symplectic-euler:dt=5e-4..2e-3", "-t", "0.1",
                  "-o", "w", "--runs", "1", "-q", "-y"]
    for words, start in ((["run", "a.json", "-n", "2", "--no-render"], "scene "), (["help", "run"], "usage"),
                         (comparison, "\nerror below")):
        text = show(words, (40, 24), PLAIN)[1]
        # paragraphs below the options have their lines; a hash is one word
        text = text[text.index(start):].split("\nFrame k")[0]
        check(all(len(line) <= 40 or line.startswith("state hash") for line in text.split("\n")),
              f"{words[0]}: 40 columns")
    narrow, wide = (re.split(r"[ \n]+", show(["help", "golden"], (width, 24), PLAIN)[1]) for width in (40, 200))
    check(narrow == wide, "and cuts no word")


def test_refusals():
    for words, size, colours, expected in (
            (["film", "out", "--show"], (39, 12), PLAIN, "found a window of 39 columns, expected at least 40"),
            (["film", "out", "--show"], (80, 12), {"TERM": "dumb"}, "TERM=dumb"),
            (["film", "out", "--show", "-o", "a.mp4"], (80, 12), PLAIN, "remove --show or --out"),
            (["plot", str(HERE / "compare.csv"), "--show", "-o", "a"], (80, 12), PLAIN, "remove --show or --out"),
            (["stability", "--extreme", "--show"], (80, 12), PLAIN, "--extreme makes no map for --show"),
            (["run", "a.json", "--show", "--no-render"], (80, 12), PLAIN, "remove --no-render"),
            (["run", "a.json", "--show", "--hash"], (80, 12), PLAIN, "cannot both write")):
        code, text = show(words, size, colours)
        check(code == 2 and expected in text, f"{' '.join(words[:3])}: {expected}")


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    for test in (test_pictures, test_diagram, test_map, test_compare, test_words, test_refusals):
        test()
    os.chdir("/")
text = "".join(f"== {name}\n{v}" for name, v in views.items()).replace("\033", "\\e")
if "--accept" in sys.argv:
    (HERE / "views.txt").write_text(text)
stored = (HERE / "views.txt").read_text()
for part in re.findall(r"== .*\n(?:(?!== ).*\n)*", text):
    check(part in stored, "views.txt: " + part.split("\n")[0])
check(len(stored) == len(text), "views.txt has no other views")
print(f"1..{n}")
sys.exit(failed > 0)
