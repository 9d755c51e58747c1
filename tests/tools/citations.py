#!/usr/bin/python3
"""citations.py ROOT - every paper that a source, header, man page or document cites, as "Names YEAR",
is an entry of docs/bibliography.md, and every entry is cited."""
import pathlib
import re
import sys

sys.argv[1:] or sys.exit("usage: citations.py ROOT")

root = pathlib.Path(sys.argv[1])
NAME = r"(?:Van )?[A-Z][a-zü]*'?[A-Z]?[a-zü]+"
YEAR = r"(?:17|18|19|20)\d\d\b"
CITED = re.compile(rf"({NAME})((?:,? and {NAME}|, {NAME})*| et al\.?),?\s+({YEAR}(?:, {YEAR})*)")
SOURCES = ["src/**/*.[ch]", "tools/**/*.[ch]", "plugins/*.[ch]", "include/**/*.h", "man/*.scd", "docs/**/*.md", "README.md"]
MONTHS = "January February March April May June July August September October November December".split()


def joined(text):
    """the text without the stars and quotes that cut a comment or a string into lines"""
    return re.sub(r'"\s*\n\s*"|\n\s*(\*|//)?\s*', " ", text.replace('" "', ""))


def cited(text):
    return {(m[1].split()[-1].replace("ü", "ue"), year) for m in CITED.finditer(joined(text))
            if m[1] not in MONTHS for year in m[3].split(", ")}


bibliography = (root / "docs/bibliography.md").read_text()
entries = {(m[1].split(",")[0].split(" et al")[0].split()[-1], m[2])
           for m in re.finditer(r"^- \*\*(.*?) (\d{4})\*\*", bibliography, re.M)}
found = {}
for pattern in SOURCES:
    for path in sorted(root.glob(pattern)):
        if path.name != "bibliography.md":
            for key in cited(path.read_text()):
                found.setdefault(key, []).append(path.relative_to(root))
wrong = [f"{name} {year}: cited in {places[0]}, not in docs/bibliography.md"
         for (name, year), places in sorted(found.items()) if (name, year) not in entries]
wrong += [f"{name} {year}: in docs/bibliography.md, and cited nowhere"
          for name, year in sorted(entries - set(found))]
print("\n".join(wrong))
print(f"{len(found)} works cited, {len(wrong)} wrong")
sys.exit(bool(wrong) or len(found) < 30)
