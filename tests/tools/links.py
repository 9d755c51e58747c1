#!/usr/bin/python3
"""links.py ROOT - every link between documents, with the heading that it names, every file of the
tree that a document names in backquotes, and every file and name of the code in CONTRIBUTING is there; tables are those of Markdown; pages have at most
so many words, outside of blocks of code and of clothsim(1)'s table of shared options; so has a version of
the change log. Of all other pages of docs, words in tables do not count, which are looked up and not read; nor
does the bibliography, a list of works."""
import pathlib
import re
import sys

sys.argv[1:] or sys.exit("usage: links.py ROOT")

root = pathlib.Path(sys.argv[1])
LINK = re.compile(r"\]\(([^)\s]+)[^)]*\)")
PATH = re.compile(r"`((?:src|tools|plugins|include|docs|scenes|tests|man|bench|examples|debian)/[\w./-]+)`")
# of every page of docs that is not named here
PROSE_WORDS = 1500
WORDS = {"README.md": 500, "CONTRIBUTING.md": 1200, "tutorial.md": 800, "speed.md": 750, "theory.md": 3500}
MAN_WORDS = 700
# one screen of the change log
VERSION_WORDS = 900
PAGE_WORDS = {"man/clothsim-contact.7.scd": 1000, "man/clothsim-scene.5.scd": 1500}
RESULT_WORDS, RESULT_ROWS = 600, 20
# names that CONTRIBUTING makes up
EXAMPLES = {"cs_noun_verb", "cs_term_resistance"}
checked, wrong = 0, []


def count(path, most, tables=True):
    """Holds a page to its limit."""
    text = re.sub(r"^```.*?^```", "", path.read_text(), flags=re.M | re.S)
    text = text if tables else re.sub(r"^\|.*", "", text, flags=re.M)
    words = len(re.sub(r"^# SHARED OPTIONS.*?(?=^# )", "", text, flags=re.M | re.S).split())
    if words > most:
        wrong.append(f"{path.relative_to(root)}: {words} words, at most {most}")


def headings(path):
    """Anchors of a document's headings: words in lower case, joined by hyphens."""
    if not path.is_file():
        return []
    found = re.findall(r"^#+ (.*)", path.read_text(), re.M)
    return [re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in found]


for document in [root / "README.md", root / "CONTRIBUTING.md", *sorted(root.glob("docs/**/*.md"))]:
    text = document.read_text()
    links = []
    if re.search(r"^(\|\[|:\[|\|  \w|:  )", text, re.M):
        wrong.append(f"{document.relative_to(root)}: a table in the notation of scdoc")
    for link in LINK.findall(text):
        name, _, heading = link.partition("#")
        links += [document.parent / name] if name and "://" not in link else []
        if heading and "://" not in link and heading not in headings(document.parent / name if name else document):
            wrong.append(f"{document.relative_to(root)}: no heading {link}")
    if document.name in WORDS:
        count(document, WORDS[document.name])
    elif document.name != "bibliography.md":
        count(document, PROSE_WORDS, tables=False)
    paths = [root / m for m in PATH.findall(text) if not re.search(r"NAME|DATE", m)]
    for path in links + paths:
        checked += 1
        if not path.exists():
            wrong.append(f"{document.relative_to(root)}: no {path.relative_to(root)}")
code = {path: path.read_text() for folder in ("src", "tools", "plugins", "include", "tests") for path in (root / folder).rglob("*.[ch]")}
names = set(re.findall(r"\bcs_\w+", "\n".join(code.values())))
for name in re.findall(r"\bcs_[a-z0-9_]+|[a-z]\w*/[\w/]+\.[ch]\b", (root / "CONTRIBUTING.md").read_text()):
    checked += 1
    if name not in names | EXAMPLES and "NAME" not in name and not any(f"/{path}".endswith(f"/{name}") for path in code):
        wrong.append(f"CONTRIBUTING.md: no {name} in the code")
for version in (root / "CHANGELOG.md").read_text().split("\n## ")[1:]:
    if len(version.split()) > VERSION_WORDS:
        wrong.append(f"CHANGELOG.md: {len(version.split())} words on {version.split()[0]}, at most {VERSION_WORDS}")
for page in sorted(root.glob("man/*.1.scd")):
    count(page, MAN_WORDS)
for name, most in PAGE_WORDS.items():
    count(root / name, most)
for page in sorted([*root.glob("docs/results/*.md"), *root.glob("docs/notes/*.md")]):
    text = page.read_text()
    if page.parent.name == "results":
        count(page, RESULT_WORDS)
    if not re.search(r"\d (November|December) 20\d\d", text):
        wrong.append(f"{page.relative_to(root)}: no date")
    tables = re.findall(r"^(?:\|.*\n)+", text, flags=re.M)
    rows = max((table.count("\n") - 2 for table in tables), default=0)
    if rows > RESULT_ROWS:
        wrong.append(f"{page.relative_to(root)}: a table of {rows} rows, at most {RESULT_ROWS}")
print("\n".join(wrong))
print(f"{checked} places, {len(wrong)} wrong")
sys.exit(bool(wrong) or checked < 50)
