#!/usr/bin/python3
"""make_rock4.py > plugins/rock4_table.h - the numbers of `rock4`, derived; checked by check_rock4.py.

A step of s stages has the stability polynomial (Abdulle 2002)
  R(z) = w(x) P(x) / (w(a) P(a)),  x = a + z/d,
where P of degree n = s - 4 is orthogonal on -1 < x < 1 with the weight w(x)^2 / sqrt(1 - x^2), and w
has two pairs of complex zeros. With the zeros of w at z = z1, z2 and their conjugates, x = 1 at
z = -e, and x = -1 at z = -l, there are six unknowns for six equations:
  R', R'', R''', R'''' = 1 at z = 0,  |R(-l)| = 0.95,  R'(-e) = 0.
The last puts the right end of the orthogonality on a maximum of R, where l is longest. Newton's method
solves them, degree after degree: z1, z2, e and l/s^2 converge as s grows.

P_0 = 1, P_j(a) = 1 and P_(j+1) = ((x - A) P_j - C P_(j-1)) / B by Stieltjes' procedure, whose integrals
are sums over the s + 1 zeros of a Chebyshev polynomial, exact up to rounding:
  S_j = <P_j, P_j>,  A = <x P_j, P_j> / S_j,  C = B_old S_j / S_(j-1),  B = a - A - C.

The n stages make a Runge-Kutta method; four stages W after it make order 4. The series of both is that
of the solution up to order 4, which gives the weights w1 .. w8 of eight trees that W must have: its sums
of b, b c, b c^2, b A c, b c^3, b c A c, b A c^2, b A A c. Ten coefficients remain. Of W's nodes c4 then
follows from c2, and c3 is free: the fraction C3 of w1 keeps the coefficients moderate. W's own stability
polynomial is w / w(a) = 1 + w1 z + w2 z^2 + w4 z^3 + w8 z^4.

c2 is for stiff modes that are driven. On y' = z (y - t^2/2) + t the n stages are off by D, W adds
  -z (w3/2 - w4) - z^2 (w7/2 - w8) - z^3 w8 c2/2,
and the sum of that and w D / w(a) is 0 at z = -l with the c2 taken: else it grows as l^3.

The error is a sum of the difference that the n stages make and of the slopes of W's stages, with weights
whose order conditions vanish up to order 3: a vector, unique but for its length, which CONSTANT sets.
With the slope at the new state in place of the difference it would grow as l in stiff modes."""
from functools import cache
from itertools import combinations_with_replacement
from math import factorial

import numpy as np

LD = np.longdouble
DEGREES = [*range(5, 25), 26, 28, 30, 33, 36, 40, 44, 48, 53, 58, 64, 70, 77, 85, 94, 104]
DAMPING, C3, CONSTANT = LD("0.95"), LD("0.5"), LD("0.01")
PI = LD("3.14159265358979323846264338327950288")
HEAD = f"""/* rock4_table.h - the numbers of rock4.c. Made by
 *   tools/make_rock4.py > plugins/rock4_table.h
 * which derives them. */
#ifndef ROCK4_TABLE_H
#define ROCK4_TABLE_H

/* The degrees, and the stages of the largest. */
enum {{ ROCK4_DEGREES = {len(DEGREES)}, ROCK4_STAGES = {DEGREES[-1]} }};

/* One degree; zeros of w, and places, are those in z. */
struct rock4_degree {{
    int stages;         /* s */
    double reach;       /* -z that is stable: x = -1 */
    double begin;       /* -z where x = 1 */
    double zeros[4];    /* of w: real and imaginary part of two; the others are conjugate */
    double factors[10]; /* of the slopes of the last stages, row by row; the last row: b */
    double error[5];    /* factors in the error: of D_n, and of these slopes */
}};

// clang-format off
static const struct rock4_degree rock4_degrees[ROCK4_DEGREES] = {{"""


def stages(u, s):
    """(a - A, 1/d, B, C) of each stage, d and the zeros of w in x"""
    d = (u[5] - u[4]) / 2
    a = 1 + u[4] / d
    zeros = [(a + u[0] / d, u[1] / d), (a + u[2] / d, u[3] / d)]
    x = np.sin(PI * (s - 2 * np.arange(s + 1)) / (2 * (s + 1)))
    weight = np.prod([(x - p) ** 2 + q ** 2 for p, q in zeros], 0) ** 2
    old, p, before, b, rows = 0 * x, 1 + 0 * x, LD(1), LD(0), []
    for _ in range(s - 4):
        size = np.sum(weight * p * p)
        shift, c = np.sum(weight * x * p * p) / size, b * size / before
        b, before = a - shift - c, size
        rows.append((a - shift, 1 / d, b, c))
        old, p = p, ((x - shift) * p - c * old) / b
    return rows, d, a, zeros


def polynomial(parts, z0):
    """w P / (w(a) P(a)) of parts from stages() at z0, and its derivatives divided by factorials, up to the fourth"""
    rows, d, a, zeros = parts
    times = lambda p, value, slope: value * p + slope * np.append(LD(0), p[:-1])
    one = np.array([1, 0, 0, 0, 0], LD)
    old, p = 0 * one, one
    for value, slope, b, c in rows:
        old, p = p, (times(p, value + z0 / d, slope) - c * old) / b
    for re, im in zeros:
        p = (times(times(p, a + z0 / d - re, 1 / d), a + z0 / d - re, 1 / d) + im ** 2 * p) / (
            (a - re) ** 2 + im ** 2)
    return p


def equations(u, s):
    parts = stages(u, s)
    r = polynomial(parts, LD(0))[1:] * [1, 2, 6, 24] - 1
    return np.array([*r, polynomial(parts, -u[5])[0] * (-1) ** s - DAMPING, polynomial(parts, -u[4])[1]])


def newton(u, s):
    for _ in range(30):
        f = equations(u, s)
        shifts = np.diag(LD(1e-8) * np.abs(u))
        slopes = np.array([(equations(u + h, s) - f) / np.sum(h) for h in shifts]).T
        step = np.linalg.solve(slopes.astype(float), -f.astype(float))
        u = u + step * min(1, 0.2 / np.max(np.abs(step / u.astype(float))))
        if np.max(np.abs(step / u.astype(float))) < 1e-15:
            break
    assert np.max(np.abs(equations(u, s))) < 1e-14, (s, equations(u, s))
    return u


def order(tree):
    return 1 + sum(map(order, tree))


def density(tree):
    return order(tree) * np.prod([density(t) for t in tree], initial=1)


def symmetry(tree):
    return np.prod([symmetry(t) for t in tree] + [factorial(tree.count(t)) for t in set(tree)], initial=1)


TREES = [()]  # rooted trees as tuples of subtrees, in ascending order
for n in range(2, 6):
    TREES += sorted({tuple(sorted(c)) for k in range(1, n) for c in
                     combinations_with_replacement(TREES, k) if sum(map(order, c)) == n - 1})
CHILDREN = [[TREES.index(child) for child in tree] for tree in TREES]
ORDER, DENSITY, SYMMETRY = (np.array([f(t) for t in TREES]) for f in (order, density, symmetry))


def slope_series(t, g):
    """elementary weights of h f(g), from those of g - y, at the node t"""
    assert abs(t - g[0]) < 1e-15
    return np.array([np.prod(g[children], initial=LD(1)) for children in CHILDREN])


SERIES = slope_series, LD(0), LD(0) * ORDER, LD(1)


def size(series, order_of):
    """of the terms of that order, by the root of the sum of squares"""
    return np.sqrt(np.sum((series / SYMMETRY)[ORDER == order_of] ** 2))


def omega(start):
    """weights of W: what is left of 1 / density by all ways to give a tree's top to the n stages"""
    c, p2, p3, p4, p5, p6, p7, p8 = (start[TREES.index(t)] for t in (
        (), ((),), ((), ()), (((),),), ((), (), ()), ((), ((),)), (((), ()),), ((((),),),)))
    w1 = 1 - c
    w2 = LD(1) / 2 - p2 - w1 * c
    w3 = LD(1) / 3 - p3 - w1 * c * c - 2 * w2 * c
    w4 = LD(1) / 6 - p4 - w1 * p2 - w2 * c
    w5 = LD(1) / 4 - p5 - w1 * c ** 3 - 3 * w2 * c * c - 3 * w3 * c
    w6 = LD(1) / 8 - p6 - w1 * c * p2 - w2 * (p2 + c * c) - w3 * c - w4 * c
    w7 = LD(1) / 12 - p7 - w1 * p3 - w2 * c * c - 2 * w4 * c
    w8 = LD(1) / 24 - p8 - w1 * p4 - w2 * p2 - w4 * c
    return w1, w2, w3, w4, w5, w6, w7, w8


def solve(matrix, right):
    """by elimination, in the precision of its arguments"""
    m = np.column_stack([np.array(matrix, LD), np.array(right, LD)])
    for i in range(len(m)):
        pivot = i + np.argmax(np.abs(m[i:, i]))
        m[[i, pivot]] = m[[pivot, i]]
        m[i] /= m[i, i]
        for k in range(len(m)):
            if k != i:
                m[k] -= m[k, i] * m[i]
    return m[:, -1]


def finish(w, z, off):
    """W's (5,4) coefficients, the last row b; off: D at z"""
    w1, w2, w3, w4, w5, w6, w7, w8 = w
    grown = (1 + z * (w1 + z * (w2 + z * (w4 + z * w8)))) * off
    c2 = 2 * (grown - z * (w3 / 2 - w4) - z * z * (w7 / 2 - w8)) / (z ** 3 * w8)
    c3 = C3 * w1
    c4 = (w6 * (w7 - c2 * w4) - w8 * (w5 - c2 * w3)) / (w4 * (w7 - c2 * w4) - w8 * (w3 - c2 * w2))
    b = solve([np.array([0, c2, c3, c4]) ** k for k in range(4)], [w1, w2, w3, w5])
    ba2, ba3 = solve([[c2, c3], [c2 ** 2, c3 ** 2]], [w4, w7])  # sums of b_i a_ij over i
    a32, a43 = w8 / (ba3 * c2), ba3 / b[3]
    a42 = (ba2 - b[2] * a32) / b[3]
    return np.array([[0, 0, 0, 0], [c2, 0, 0, 0], [c3 - a32, a32, 0, 0], [c4 - a42 - a43, a42, a43, 0], b])


class Method:
    """of one degree"""

    def __init__(self, s, u):
        rows = stages(u, s)[0]
        self.rows = [(value / b, rate / b) for value, rate, b, _ in rows]
        self.nodes, old, c = [LD(0)], LD(0), LD(0)
        for last, rate in self.rows:
            old, c = c, last * c + (1 - last) * old + rate
            self.nodes.append(c)
        z = -u[5]
        off = self.begin(lambda t, y: z * (y - t * t / 2) + t, LD(0), np.zeros(1, LD), LD(1))[0] - c * c / 2
        self.table = finish(omega(self.begin(*SERIES)), z, off)
        _, *terms = self.stages(*SERIES)
        low = ORDER <= 3
        error = np.append(LD(1), solve(np.array(terms)[1:, low].T, -terms[0][low]))
        self.error = CONSTANT / size(error @ terms, 4) * error

    def begin(self, f, t, y, h):
        """y and n stages"""
        old = g = 0 * y
        for (last, rate), node in zip(self.rows, self.nodes):
            old, g = g, last * g + (1 - last) * old + rate * h * f(t + node * h, y + g)
        return y + g

    def stages(self, f, t, y, h):
        """the new state, the difference that the first n stages make, and h times the slopes of W"""
        g, slopes = self.begin(f, t, y, h), []
        for row in self.table[:4]:
            slopes.append(h * f(t + (self.nodes[-1] + np.sum(row)) * h, g + row[:len(slopes)] @ slopes
                                if slopes else g))
        return g + sum(b * k for b, k in zip(self.table[4], slopes)), g - y, *slopes

    def step(self, f, t, y, h):
        """the new state and the error"""
        new, *terms = self.stages(f, t, y, h)
        return new, sum(e * k for e, k in zip(self.error, terms))


@cache
def degrees():
    """list of (s, u), from the polynomial of degree 5 with the longest interval"""
    roots = np.roots([0.00411, 1 / 24, 1 / 6, 1 / 2, 1, 1])
    pairs = sorted((z for z in roots if z.imag > 0), key=lambda z: -z.real)
    u = np.array([pairs[0].real, pairs[0].imag, pairs[1].real, pairs[1].imag, 4.6, 6], LD)
    found = []
    for before, s in zip([DEGREES[0], *DEGREES], DEGREES):
        u = newton(u * [1, 1, 1, 1, 1, LD(s) ** 2 / LD(before) ** 2], s)
        found.append((s, u))
    return found


def main():
    print(HEAD)
    for s, u in degrees():
        method = Method(s, u)
        t = method.table
        text = lambda numbers: ", ".join(f"{float(v):.17g}" for v in numbers)
        wrap = lambda v: "{" + (",\n      ".join(text(v[i:i + 4]) for i in range(0, len(v), 4))) + "}"
        print(f"    {{{s}, {text(u[5:])}, {text(u[4:5])},\n     {wrap(u[:4])},\n     "
              + wrap([*t[1, :1], *t[2, :2], *t[3, :3], *t[4]]) + ",\n     " + wrap(method.error) + "},")
    print("};\n// clang-format on\n\n#endif")


if __name__ == "__main__":
    main()
