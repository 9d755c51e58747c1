#!/usr/bin/env python3
"""links.py ROOT - every link between documents, and every file of the tree that a document names in
backquotes, is there."""
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1])
LINK = re.compile(r"\]\(([^)#\s]+)[^)]*\)")
PATH = re.compile(r"`((?:src|plugins|include|docs|scenes|tests|man|bench|examples|debian)/[\w./-]+)`")
checked, wrong = 0, []
for document in [root / "README.md", root / "CONTRIBUTING.md", *sorted(root.glob("docs/*.md"))]:
    text = document.read_text()
    links = [document.parent / m for m in LINK.findall(text) if "://" not in m]
    paths = [root / m for m in PATH.findall(text) if not re.search(r"NAME|DATE", m)]
    for path in links + paths:
        checked += 1
        if not path.exists():
            wrong.append(f"{document.relative_to(root)}: no {path.relative_to(root)}")
print("\n".join(wrong))
print(f"{checked} places, {len(wrong)} wrong")
sys.exit(bool(wrong) or checked < 50)
