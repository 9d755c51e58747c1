#!/usr/bin/env python3
"""Tables of the benchmark as Markdown: one folder of results, or two side by side.

  bench/report.py FOLDER                 every figure of FOLDER
  bench/report.py BEFORE AFTER           what was measured in both, and how many times faster
  bench/report.py --page PAGE FOLDER...  the same, put into PAGE between the lines
                                         <!-- bench SECTION --> and <!-- end -->

Sections are CSV files as the benchmark writes them; "# keys" says how many of the first columns
name a case, "# measured" which column is compared. A gain in brackets is no more than noise: the
medians, or the least values, differ by less than a tenth, or contradict each other.
"""
import argparse
import csv
import pathlib
import re
import sys

SECTIONS = ["limits", "kernels", "steps", "plain", "thesis", "pairs", "contact", "pictures", "pipeline",
            "bdf"]
# of figures that belong to the measured one
RANGE = re.compile(r"(min|median|max)_(ns|ms|s)$")


class Table:
    """One CSV file: what its first lines say, its columns, and its rows by key."""

    def __init__(self, path):
        lines = path.read_text().splitlines()
        self.facts = dict(re.match(r"# (\w+): (.*)", line).groups()
                          for line in lines if line.startswith("#"))
        rows = list(csv.reader(line for line in lines if not line.startswith("#")))
        self.columns, rows = rows[0], rows[1:]
        self.n_keys = int(self.facts["keys"])
        self.measured = self.facts["measured"]
        self.rows = {tuple(row[:self.n_keys]): dict(zip(self.columns, row)) for row in rows}

    def number(self, key, column):
        text = self.rows.get(key, {}).get(column, "")
        return float(text) if text else None

    def least(self, key):
        unit = self.measured.rsplit("_", 1)[1]
        least = self.number(key, f"min_{unit}")
        return self.number(key, self.measured) if least is None else least


def read(folder):
    tables = {}
    for section in SECTIONS:
        path = pathlib.Path(folder) / f"{section}.csv"
        if path.exists():
            tables[section] = Table(path)
    if not tables:
        sys.exit(f"report.py: {folder}: none of {', '.join(s + '.csv' for s in SECTIONS)}")
    return tables


def layout(head, rows, n_words):
    lines = [head, ["---"] * n_words + ["---:"] * (len(head) - n_words)] + rows
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def single(table):
    rows = [[row[column] for column in table.columns] for row in table.rows.values()]
    return layout(table.columns, rows, table.n_keys)


def gain(before, after, key):
    """Before over after, in brackets where that is noise."""
    ratio = before.number(key, before.measured) / after.number(key, after.measured)
    least = before.least(key) / after.least(key)
    real = min(ratio, least) > 1.1 or max(ratio, least) < 1 / 1.1
    return f"{ratio:.2f}" if real else f"({ratio:.2f})"


def pair(before, after):
    """Keys, the measured column twice, the gain, and what else there is of the later one."""
    others = [column for column in after.columns[after.n_keys:]
              if column != after.measured and not RANGE.match(column)]
    head = after.columns[:after.n_keys]
    head = head + [f"{after.measured} before", "after", "gain"] + others
    rows = []
    for key in list(before.rows) + [key for key in after.rows if key not in before.rows]:
        both = key in before.rows and key in after.rows
        rows.append(list(key) + [table.rows.get(key, {}).get(table.measured, "-")
                                 for table in (before, after)] +
                    [gain(before, after, key) if both else "-"] +
                    [after.rows.get(key, {}).get(column, "") for column in others])
    return layout(head, rows, after.n_keys)


def source(table):
    facts = table.facts
    keys = ("date", "version", "machine", "compiler")
    return ", ".join(facts[key] for key in keys) + f", threads: {facts['threads']}"


def text_of(section, folders):
    """One section of all folders that have it, with a line that says where it is from."""
    tables = [folder[section] for folder in folders if section in folder]
    if not tables:
        return None
    body = single(tables[0]) if len(tables) == 1 else pair(*tables)
    names = [""] if len(tables) == 1 else ["before: ", "after: "]
    return body + "\n\n" + "  \n".join(f"*{name}{source(t)}*" for name, t in zip(names, tables))


def fill(page, folders):
    def put(match):
        text = text_of(match[1], folders)
        return f"<!-- bench {match[1]} -->\n{text}\n<!-- end -->" if text else match[0]

    path = pathlib.Path(page)
    path.write_text(re.sub(r"<!-- bench (\w+) -->\n.*?<!-- end -->", put, path.read_text(),
                           flags=re.DOTALL))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folders", nargs="+", metavar="FOLDER", help="one, or before and after")
    parser.add_argument("--page", help="Markdown file to put the tables into")
    asked = parser.parse_args()
    if len(asked.folders) > 2:
        parser.error("at most two folders")
    folders = [read(folder) for folder in asked.folders]
    if len({table.facts["mode"] for tables in folders for table in tables.values()}) > 1:
        sys.exit("report.py: quick and full results have other models, and are not compared")
    if asked.page:
        fill(asked.page, folders)
        return
    for section in SECTIONS:
        text = text_of(section, folders)
        if text:
            print(f"## {section}\n\n{text}\n")


if __name__ == "__main__":
    main()
