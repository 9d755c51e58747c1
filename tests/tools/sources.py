"""Shared by the tests of this folder: files of the tree, code and comments, the closing line."""
import re

# strings are matched first, so that a comment sign within one is none
TOKEN = re.compile(r"\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])*'|(/\*.*?\*/|//[^\n]*)", re.S)
PRODUCT = ("src", "tools", "plugins", "include")


def files(root, trees=PRODUCT, pattern="*.[ch]"):
    """Paths below the folders `trees` of root, in one order."""
    return [path for tree in trees for path in sorted((root / tree).rglob(pattern))]


def spaces(match):
    return re.sub(r"[^\n]", " ", match.group(0))


def without_comments(text):
    return TOKEN.sub(lambda m: spaces(m) if m.group(1) else m.group(0), text)


def code_of(text):
    """The text with comments, strings and characters replaced by spaces."""
    return TOKEN.sub(spaces, text)


def comments(text):
    """(first line from 1, column from 0, text) of each comment; neighbouring // lines are one."""
    found, last = [], -1
    for m in TOKEN.finditer(text):
        if not m.group(1):
            continue
        line = text.count("\n", 0, m.start()) + 1
        column = m.start() - text.rfind("\n", 0, m.start()) - 1
        if m.group(1).startswith("//") and line == last + 1 and found[-1][1] == column:
            found[-1] = (*found[-1][:2], found[-1][2] + "\n" + m.group(1))
        else:
            found.append((line, column, m.group(1)))
        last = line if m.group(1).startswith("//") else -1
    return found


class Checks:
    """Counts what held, prints a line for what did not."""

    def __init__(self):
        self.passed = self.failed = 0

    def check(self, held, message):
        self.passed += bool(held)
        self.failed += not held
        if not held:
            print(message)

    def end(self, least=1):
        """The closing line, and the exit code: fewer checks than `least` is a failure."""
        if self.passed + self.failed < least:
            self.check(False, f"only {self.passed + self.failed} things were read")
        print(f"{self.passed} passed, {self.failed} failed")
        return int(self.failed > 0)
