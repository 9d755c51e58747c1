#!/usr/bin/python3
"""release.py ROOT - every file that names the version of the program names that of meson.build."""
import json
import pathlib
import re
import sys

sys.argv[1:] or sys.exit("usage: release.py ROOT")

root = pathlib.Path(sys.argv[1])
version = re.search(r"^  version: '([\d.]+)'", (root / "meson.build").read_text(), re.M)[1]
told = {
    "CITATION.cff": re.search(r"^version: (\S+)", (root / "CITATION.cff").read_text(), re.M)[1],
    "codemeta.json": json.loads((root / "codemeta.json").read_text())["version"],
    "CHANGELOG.md": re.search(r"^## ([\d.]+)", (root / "CHANGELOG.md").read_text(), re.M)[1],
    "debian/changelog": re.match(r"clothsim \(([\d.]+)-", (root / "debian/changelog").read_text())[1],
}
wrong = [f"{name}: found {found}, expected {version} as in meson.build"
         for name, found in told.items() if found != version]
print("\n".join(wrong) or f"version {version} in {len(told)} files")
sys.exit(1 if wrong else 0)
