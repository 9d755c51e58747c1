#!/usr/bin/python3
"""texts.py PROGRAM: names that a user or a stranger can set, full of quotes, escapes, tags and control
characters, and every output that has them (as TAP). No text is code in any of them.
"""
import csv
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import xml.dom.minidom
import zlib
from html.parser import HTMLParser
from pathlib import Path

sys.argv[1:] or sys.exit("usage: texts.py PROGRAM")

PROGRAM = str(Path(sys.argv[1]).resolve())
SHELL = "`touch PWNED`$(touch PWNED)\";system(\"touch PWNED\");#'"
MARKUP = "<img src=x onerror=alert(1)>&amp;|*_[x](y)~"
CONTROL = "\n```\n<b>\x1b[31m\x07\u009b31m\u202e\u2066\u200f\u2028"
NAME = SHELL + MARKUP + CONTROL
# no text: control characters but line breaks and tabs, those that turn the direction, or hide
FORBIDDEN = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ufeff]")
TAGS = set("html head meta title style body h1 h2 h3 pre p code table tbody tr th td div span i figure img figcaption br "
           "script section svg defs g symbol path use rect clippath mask circle".split())
SCENE = {"about": NAME, "bodies": [{"cloth": {"grid": [2, 2], "velocity": [0, 0, 0.1]}, "mass": {"particle": 0.01},
                                    "springs": {"stretch": 40, "damping": 0.01}, "pins": [0]}],
         "render": {"size": [32, 24]}, "time": {"fps": 20}}

n = failed = 0


def told(title, *wrong):
    global n, failed
    wrong = [w for w in wrong if w]
    n, failed = n + 1, failed + bool(wrong)
    print("not ok" if wrong else "ok", n, "-", title)
    for w in wrong:
        print("#", ascii(w))


class Page(HTMLParser):
    """What is wrong with a page: tags that it has not, and handlers."""
    def __init__(self):
        super().__init__()
        self.wrong = []

    def handle_starttag(self, tag, attributes):
        if tag not in TAGS or any(k.startswith("on") or k == "href" for k, _ in attributes):
            self.wrong.append(f"<{tag} {attributes}>")
        if tag == "img" and not dict(attributes)["src"].startswith("data:image/png;base64,"):
            self.wrong.append(f"<img {attributes}>")


def html(path, text):
    page = Page()
    page.feed(text)
    return page.wrong + ["scripts"] * (text.count("<script") != text.count("<head"))


def markdown(path, text):
    outside = re.sub(r"^```\n.*?^```\n", "", text, flags=re.M | re.S)
    return [m.group() for m in re.finditer(r"(?<!\\)(<|```)\S*|(?<!\\)\[x(?<!\\)\]\(y", outside)]


def table(path, text):
    rows = list(csv.reader(text.split("\n")[:-1]))
    return ["rows of other lengths"] * (len({len(row) for row in rows}) != 1)


def junit(path, text):
    page = xml.dom.minidom.parseString(text)
    names = {e.tagName for e in page.getElementsByTagName("*")}
    return sorted(names - {"testsuite", "testcase", "failure"})


def svg(path, text):
    page = xml.dom.minidom.parseString(text)
    names = {e.tagName.lower() for e in page.getElementsByTagName("*")}
    return sorted(names - TAGS)


def png(path):
    """Its texts must be no less clean."""
    data, at, wrong = path.read_bytes(), 8, []
    while at < len(data):
        length, kind = int.from_bytes(data[at:at + 4], "big"), data[at + 4:at + 8]
        body = data[at + 8:at + 8 + length]
        if kind in (b"tEXt", b"zTXt", b"iTXt"):
            wrong += FORBIDDEN.findall(body.replace(b"\0", b"", 1).decode("utf-8"))
        at += length + 12
    return wrong


def pdf(path):
    """Texts are strings of its streams; its objects name no action."""
    data = path.read_bytes()
    parts = [zlib.decompress(part) for part in re.findall(rb"stream\n(x.*?)\nendstream", data, re.S)]
    return [word for word in (b"/JavaScript", b"/Launch", b"/OpenAction", b"/URI")
            if any(word in part for part in [data, *parts])]


READERS = {".html": html, ".md": markdown, ".csv": table, ".svg": svg, ".xml": junit,
           ".json": lambda path, text: [] if json.loads(text) else ["empty"],
           ".txt": lambda path, text: []}


def look(title, folder, ran, wanted=()):
    wrong = [f"exit code {ran.returncode}"] * (ran.returncode != 0)
    endings = set()
    for out in (ran.stdout, ran.stderr):
        wrong += FORBIDDEN.findall(out.decode("utf-8"))
    for path in sorted(Path(folder).rglob("*")):
        endings.add(path.suffix)
        if path.suffix in READERS:
            text = path.read_text(encoding="utf-8")
            wrong += [f"{path.name}: {w}" for w in FORBIDDEN.findall(text) + READERS[path.suffix](path, text)]
        elif path.suffix in (".png", ".pdf"):
            wrong += [f"{path.name}: {w}" for w in (png if path.suffix == ".png" else pdf)(path)]
        wrong += [f"name {path.name}"] * bool(FORBIDDEN.search(path.name) or "\n" in path.name)
    wrong += [f"no {ending}" for ending in wanted if ending not in endings]
    wrong += [str(path) for path in Path().rglob("PWNED*")]
    told(title, *wrong)


def run(*words):
    return subprocess.run([PROGRAM, *words], capture_output=True, stdin=subprocess.DEVNULL)


COMPARE = ["-t", "0.05", "-i", "rk4:dt=1e-3..2e-3,tr-bdf2:dt=2e-3..2e-3", "--runs", "1"]
PICTURES = {".png", ".svg", ".pdf"} if "--diagrams" in sys.argv else set()


def test():
    scene = NAME + ".json"
    Path(scene).write_text(json.dumps(SCENE))
    Path("plain.json").write_text(json.dumps(SCENE))
    look("compare", "c", run("compare", scene, *COMPARE, "-o", "c", "--report", "--pictures", "--ledger"),
         {".csv", ".json", ".md", ".html", ".png", *PICTURES})
    look("stability", "m", run("stability", scene, "-i", "rk4", "--columns", "2", "--rows", "2", "-t", "0.02",
                               "-o", "m"), {".csv", ".json", *PICTURES})
    look("run", "r", run("run", scene, "-n", "2", "-o", "r", "--renderer", "cpu", "--monitor", "r/m.csv"),
         {".json", ".png"})
    look("sweep", "w", run("sweep", scene, "-i", "rk4:dt=0.002", "-n", "1", "-s",
                           "bodies[0].springs.stretch=50,60", "-o", "w"), {".csv"})
    look("scene", "none", run("scene", scene))
    look("advise", "a", run("advise", scene, "-i", "rk4", "-t", "0.02"))
    if PICTURES:
        look("plot --title", "t", run("plot", "c/compare.csv", "--title", NAME, "-o", "c/t"))
        look("plot --show --title", "t", run("plot", "c/compare.csv", "--title", NAME, "--show"))
        shutil.copytree("c", SHELL)
        look("a folder's name", "t", run("plot", SHELL + "/compare.csv"))
        # a stranger's table has no checks
        rows = list(csv.DictReader(open("c/compare.csv", newline="", encoding="utf-8")))
        names = [name for name in rows[0] if name != "check"]
        os.mkdir("s")
        with open("s/compare.csv", "w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, names, extrasaction="ignore", lineterminator="\n")
            writer.writeheader()
            writer.writerows({**row, "series": (SHELL + MARKUP + CONTROL.replace("\n", "")),
                              "family": "<b>\x1b"} for row in rows)
        clean = Path("s/compare.csv")
        ran = run("plot", "s/compare.csv")
        shown = run("plot", "s/compare.csv", "--show")
        clean.rename("stranger")
        look("names in a stranger's table", "s", ran, PICTURES)
        look("in the terminal", "none", shown)
    # a name of a line, as no row of a golden table holds more
    line = NAME.replace("\n", "") + ".json"
    shutil.copy("plain.json", line)
    for name in (line, scene):
        added = run("golden", "--folder", "g", "--add", name, "-n", "1", "-i", "rk4", "--image")
    hashes = Path("g/hash.tsv")
    hashes.write_text(re.sub(r"\t1\t\w+\t", "\t1\t0\t", hashes.read_text(encoding="utf-8")), encoding="utf-8")
    os.mkdir("reports")
    checked = run("golden", "--folder", "g", "--github", "--renderer", "cpu", "--html", "reports/a.html", "--json",
                  "reports/a.json", "--junit", "reports/a.xml")
    told("a golden row has no line breaks, and differs", "" if added.returncode == 2 else "added",
         "" if checked.returncode == 1 and b"::error file=" in checked.stdout else ascii(checked))
    checked.returncode = 0
    look("golden", "reports", checked, {".html", ".json", ".xml"})
    bad = run("run", "missing" + NAME)
    told("a message is one line", *FORBIDDEN.findall(bad.stderr.decode("utf-8")),
         "" if bad.stderr.count(b"\n") == 1 else "lines")


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    test()
    os.chdir("/")
print(f"1..{n}")
sys.exit(failed > 0)
