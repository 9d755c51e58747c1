#!/usr/bin/env python3
"""A Runge-Kutta method whose tableau is a file, as a method of clothsim: clothsim-program(7).

    clothsim compare scenes/drum.json -i tableau:tableaux/ralston3.json,rk4

The file is JSON: name, order, source, A (a row for each stage), b, and if they differ from the row sums
of A, c. Numbers are JSON's or fractions as text, "-5/9". A may have a diagonal: such a stage is solved by
Newton's method. `embedded` is the b of a method of lower order: its distance is the error that rtol bounds.
"""
import json
import math
import sys
from fractions import Fraction

import numpy as np
from clothsim_program import Unable, serve

KEYS = {"name", "order", "source", "A", "b", "c", "embedded"}
ITERATIONS = 20


def fail(path, place, found, expected):
    """Ends with one line."""
    sys.exit(f"tableau.py: {path}: {place}: found {json.dumps(found)[:60]}, expected {expected}")


def numbers(path, place, row, length):
    """The fractions of a row."""
    if not isinstance(row, list) or len(row) > length:
        fail(path, place, row, f"at most {length} numbers")
    values = []
    for k, entry in enumerate(row):
        try:
            values.append(Fraction(entry))
            if isinstance(entry, bool) or abs(values[-1]) > 10**9:
                raise ValueError
        except (TypeError, ValueError, ZeroDivisionError, OverflowError):
            fail(path, f"{place}[{k}]", entry, "a number or a fraction as text, at most 10^9")
    return values + [Fraction(0)] * (length - len(row))


def read(path):
    """The tableau: name, order, source, and A, b, c, embedded of exact fractions."""
    try:
        with open(path, encoding="utf-8") as file:
            table = json.load(file)
    except json.JSONDecodeError as why:
        sys.exit(f"tableau.py: {path}:{why.lineno}:{why.colno}: {why.msg}")
    except (OSError, UnicodeDecodeError) as why:
        sys.exit(f"tableau.py: {path}: {getattr(why, 'strerror', None) or why}")
    if not isinstance(table, dict):
        fail(path, "the file", table, "an object with name, order, source, A and b")
    for key in sorted(set(table) - KEYS):
        fail(path, key, table[key], f"one of {', '.join(sorted(KEYS))}")
    for key, kind in (("name", str), ("order", int), ("source", str), ("A", list), ("b", list)):
        if not isinstance(table.get(key), kind):
            fail(path, key, table.get(key), {str: "a text", int: "a whole number", list: "a list"}[kind])
    stages = len(table["b"])
    if len(table["A"]) != stages:
        fail(path, "A", len(table["A"]), f"{stages} rows, as many as b has numbers")
    A = [numbers(path, f"A[{i}]", row, stages) for i, row in enumerate(table["A"])]
    for i, row in enumerate(A):
        if any(row[i + 1:]):
            fail(path, f"A[{i}]", table["A"][i], f"no number behind the {i + 1}th: stages follow each other")
    b = numbers(path, "b", table["b"], stages)
    c = numbers(path, "c", table.get("c", []), stages) if "c" in table else [sum(row) for row in A]
    for i, row in enumerate(A):
        if abs(c[i] - sum(row)) > 1e-12:
            fail(path, f"c[{i}]", float(c[i]), f"{float(sum(row))}, the sum of A[{i}]")
    embedded = numbers(path, "embedded", table["embedded"], stages) if "embedded" in table else None
    for place, weights in (("b", b), ("embedded", embedded or b)):
        if abs(sum(weights) - 1) > 1e-12:
            fail(path, place, float(sum(weights)), "numbers whose sum is 1")
    return {**table, "A": A, "b": b, "c": c, "embedded": embedded}


class Method:
    """Steps by a tableau. The order of all sums is that of the stages."""

    def __init__(self, table):
        self.A = [[float(a) for a in row] for row in table["A"]]
        self.b, self.c = ([float(w) for w in table[key]] for key in "bc")
        self.order = table["order"]
        self.error = table["embedded"] and [float(w - e) for w, e in zip(table["b"], table["embedded"])]
        self.implicit = any(row[i] for i, row in enumerate(self.A))
        self.h = 0.0

    def solve(self, host, t, g, base):
        """The slope k = F(t, base + g k): M (v - vb) = g f(xb + g v, v) by Newton's method."""
        n3 = 3 * host.n
        y, mass = base.copy(), np.tile(host.mass, 3)
        y[:n3] = base[:n3] + g * y[n3:]
        for _ in range(ITERATIONS):
            rest = g * host.force(t, y).copy() - mass * (y[n3:] - base[n3:])
            host.solve_setup(t, y, 1.0, -g, -g * g)
            change = host.solve(rest, 1e-10).copy()
            y[n3:] += change
            y[:n3] = base[:n3] + g * y[n3:]
            host.counts[2] += 1
            if np.abs(change).max() <= 1e-13 * (np.abs(y[n3:]).max() + host.speed_scale):
                return np.concatenate([y[n3:], (y[n3:] - base[n3:]) / g])
        raise Unable(f"a stage at t = {t:.9g} s is not solved in {ITERATIONS} iterations")

    def slopes(self, host, t, h, y):
        k = []
        for i, row in enumerate(self.A):
            stage = y + sum((h * row[j] * k[j] for j in range(i) if row[j]), np.zeros_like(y))
            time = t + self.c[i] * h
            k.append(self.solve(host, time, h * row[i], stage) if row[i] else host.rate(time, stage))
        return k

    @staticmethod
    def combine(h, weights, k):
        return sum((h * w * s for w, s in zip(weights, k) if w), np.zeros_like(k[0]))

    def step(self, host, t, h, y):
        return y + self.combine(h, self.b, self.slopes(host, t, h, y))

    def advance(self, host, t0, t1, y):
        """Steps whose error is below the tolerance, or with dt > 0 equal ones."""
        if host.options["dt"] > 0:
            return host.steps(self.step, None, t0, t1, y)
        rtol, t = host.options["rtol"], t0
        scale = rtol * np.repeat([host.length_scale, host.speed_scale], 3 * host.n)
        self.h = self.h or 1e-3 * (t1 - t0)
        while t < t1:
            parts = max(math.ceil((t1 - t) / self.h * (1 - 1e-9)), 1)
            h = (t1 - t) / parts
            k = self.slopes(host, t, h, y)
            new = y + self.combine(h, self.b, k)
            weight = scale + rtol * np.maximum(np.abs(y), np.abs(new))
            error = math.sqrt(np.mean((self.combine(h, self.error, k) / weight) ** 2))
            good = error <= 1 and host.max_step_fraction(t, y[:3 * host.n], t + h, new[:3 * host.n]) >= 1
            growth = 0.9 * max(error, 1e-10) ** (-1 / self.order) if math.isfinite(error) else 0.1
            if good:
                t = t + h if parts > 1 else t1
                y, _ = host.commit(t, h, new)
            else:
                host.counts[0] += 1
            self.h = h * min(max(growth if error > 1 or good else 0.5, 0.1), 5.0)
            if h < 1e-12 * (t1 - t0):
                raise Unable(f"a step of {h:.3g} s at t = {t:.9g} s is still refused")
        return y


if len(sys.argv) != 2:
    sys.exit("tableau.py: expected a file: python3 tableau.py FILE.json")
table = read(sys.argv[1])
method = Method(table)
words = {"name": table["name"], "order": table["order"], "source": table["source"],
         "summary": f"Runge-Kutta method of {len(table['b'])} stages by a tableau",
         "traits": "implicit" if method.implicit else "", "needs": "solve" if method.implicit else ""}
if method.error:
    # the length of the next step would not survive a checkpoint: it restarts there
    words["traits"] += " adaptive"
    serve(advance=method.advance, restart=lambda host, t, y: setattr(method, "h", 0.0), history=None,
          options=[("rtol", "", 1e-6, 1e-13, 0.1, "local error of a step, relative to the value"),
                   ("dt", "s", 0.0, 0.0, 1.0, "step without error control; 0: by the error")], **words)
else:
    serve(step=method.step, **words)
