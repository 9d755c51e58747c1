#!/usr/bin/python3
"""check_rock4.py - checks the numbers that tools/make_rock4.py derives, degree after degree: the order
conditions of the step (4) and of its error (3), the damping on the real axis, the half disc |z| < 3, W's
polynomial, nodes within the step (to 1.6 % beyond). --errors prints those on a nonlinear stiff equation."""
import contextlib
import io
import re
import sys
from pathlib import Path

import numpy as np

import make_rock4
from make_rock4 import DAMPING, DENSITY, LD, ORDER, SERIES, Method, degrees, size, stages


def check(s, u, method):
    """asserts order and stability; prints constants and what a rounding error of each stage can grow to"""
    series, estimate = method.step(*SERIES)
    missed = series - 1 / LD(1) / DENSITY
    assert max(size(missed, k) for k in (1, 2, 3, 4)) < 1e-15, s
    assert max(size(estimate, k) for k in (1, 2, 3)) < 1e-15, s
    nodes = [*method.nodes, *(method.nodes[-1] + method.table.sum(1))]
    assert min(nodes) >= 0 and max(nodes) < 1.016, (s, nodes)
    z = -u[5] * np.linspace(0, 1, 20 * s * s).astype(LD) ** 2
    r, moved, *_ = method.stages(lambda t, y: z * y, LD(0), 1 + 0 * z, LD(1))
    assert np.max(np.abs(r)) <= 1 and np.max(np.abs(r[z < -0.06])) < DAMPING + 1e-4, s
    _, d, a, zeros = stages(u, s)
    w = np.prod([((a + z / d - p) ** 2 + q ** 2) / ((a - p) ** 2 + q ** 2) for p, q in zeros], 0)
    assert np.max(np.abs((1 + moved) * w - r)) < 1e-4, s  # rounding, times w, which is large
    later, beyond, growth = 1 + 0 * z, 0 * z, 1 + 0 * z
    for (last, rate), (after, _) in zip(method.rows[:0:-1], [(LD(1), 0), *method.rows[:1:-1]]):
        later, beyond = (last + rate * z) * later + (1 - after) * beyond, later
        growth += np.abs(later)
    half = LD(3) * np.exp(0.5j * np.pi * np.linspace(1, 2, 500))  # |z| = 3 on the left
    assert np.max(np.abs(method.step(lambda t, y: half * y, LD(0), 1 + 0 * half, LD(1))[0])) < 1, s
    print(f"{s:3}: l/s^2 {float(u[5]) / s ** 2:.4f}, error constant {float(size(missed, 5)):.1e}, "
          f"coefficients to {float(np.max(np.abs(method.table))):.2f}, growth of rounding "
          f"{float(np.max(growth * np.abs(w))):.1e}")


def converge(method, s, u):
    """prints errors on u' = k u_xx + u^2 (1 - u) + sin(5 t) / 2, in steps of l over the radius and below"""
    x = np.linspace(0, 1, 41)[1:-1]
    k = float(u[5]) / (0.5 / 20 * 6400) * 0.99

    def slope(t, y):
        return (k * 1600 * (np.append(y[1:], 1) - 2 * y + np.append(0, y[:-1])) + y * y * (1 - y)
                + np.sin(5 * t) / 2)

    ends = []
    for count in (20, 40, 80, 640):
        y = np.sin(np.pi * x) + x
        for i in range(count):
            y = method.step(slope, LD(i) / 2 / count, y, LD(1) / 2 / count)[0]
        ends.append(y)
    print(f"{s:3}: errors " + " ".join(f"{float(np.max(np.abs(y - ends[3]))):.1e}" for y in ends[:3]))


def compare():
    """asserts that the table of the plugin has the numbers that are derived"""
    made = io.StringIO()
    with contextlib.redirect_stdout(made):
        make_rock4.main()
    table = Path(__file__).parents[1] / "plugins/rock4_table.h"
    made, shipped = (np.array(re.findall(r"-?\d+\.?\d*(?:e-?\d+)?", text.split("= {")[-1]), float)
                     for text in (made.getvalue(), table.read_text()))
    assert made.size == shipped.size > 700 and np.allclose(made, shipped, 1e-12, 1e-15)


def main():
    compare()
    for s, u in degrees():
        method = Method(s, u)
        check(s, u, method)
        if s in (5, 8, 20, 44) and "--errors" in sys.argv:
            converge(method, s, u)


if __name__ == "__main__":
    main()
