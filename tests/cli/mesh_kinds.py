#!/usr/bin/python3
"""Loads every kind of OBJ file that 144 public ones of seven repositories fall into, each written
small, as a collider and as cloth (as TAP).

usage: mesh_kinds.py PROGRAM

A collider loads without a word. Cloth loads after one line that says what was mended. Of both the
area, and of closed ones the volume, is that of the solid that was meant; 2 kg/m2 at 1 m/s have
a kinetic energy of as many joules as the cloth has square metres.

107 of the files are sound surfaces, which differ in nothing that a reader sees but the spelling
of corners: they are one kind a spelling here, and 15 of them the three kinds of doubled vertices.
18 have edges of three or four triangles, 8 faces without area, 3 loose vertices, and 8 are refused
by readers that know less of the format.
"""
import json
import math
import os
import re
import subprocess
import sys
import tempfile

import numpy as np

sys.argv[1:] or sys.exit("usage: mesh_kinds.py PROGRAM")


def obj(points, faces, form="{v}"):
    """The text of an OBJ file; corners count from 0, and form spells one."""
    return ("".join("v %.9g %.9g %.9g\n" % tuple(p) for p in points) +
            "".join("f " + " ".join(form.format(v=v + 1, t=v % 4 + 1, n=1, last=v - len(points))
                                    for v in face) + "\n" for face in faces))


def apart(points, groups):
    """Each group of faces with vertices of its own."""
    all_points, all_faces = [], []
    for group in groups:
        own = {v: len(all_points) + k for k, v in enumerate(sorted({v for f in group for v in f}))}
        all_points += [points[v] for v in own]
        all_faces += [[own[v] for v in f] for f in group]
    return all_points, all_faces


def box(x=0, y=0, z=0, w=1):
    points = [(x + w * (k & 1), y + (k >> 1 & 1), z + (k >> 2)) for k in range(8)]
    return points, [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2],
                    [1, 3, 7, 5]]


def sheet(columns, rows):
    """Squares of 0.1 m."""
    points = [(0.1 * i, 0.1 * j, 0) for j in range(rows) for i in range(columns)]
    return points, [[j * columns + i, j * columns + i + 1, (j + 1) * columns + i + 1,
                     (j + 1) * columns + i] for j in range(rows - 1) for i in range(columns - 1)]


def fan_cylinder(n):
    """A prism of n sides about the y axis, radius and height 1, in triangles; its parts: side,
    bottom, top."""
    ring = [(math.cos(2 * math.pi * k / n), math.sin(2 * math.pi * k / n)) for k in range(n)]
    points = [(x, y, z) for y in (0, 1) for z, x in ring] + [(0, 0, 0), (0, 1, 0)]
    side, bottom, top = [], [], []
    for k in range(n):
        a, b = k, (k + 1) % n
        side += [[a, b, n + b], [a, n + b, n + a]]
        bottom.append([2 * n, b, a])
        top.append([2 * n + 1, n + a, n + b])
    base, edge = n / 2 * math.sin(2 * math.pi / n), 2 * math.sin(math.pi / n)
    return points, (side, bottom, top), 2 * base + n * edge, base


def seamed_sphere(n, m):
    """A sphere of n sectors and m bands as texture coordinates divide it: its first meridian is
    there twice, and each pole n + 1 times; quads at the poles have two equal places."""
    rings = [(math.sin(math.pi * j / m), math.cos(math.pi * j / m)) for j in range(m + 1)]
    rings[m] = (0, -1)
    turns = [(math.sin(2 * math.pi * (i % n) / n), math.cos(2 * math.pi * (i % n) / n))
             for i in range(n + 1)]
    points = [(r * x, y, r * z) for r, y in rings for x, z in turns]
    faces = [[j * (n + 1) + i, (j + 1) * (n + 1) + i, (j + 1) * (n + 1) + i + 1, j * (n + 1) + i + 1]
             for j in range(m) for i in range(n)]
    area = volume = 0
    unit = n / 2 * math.sin(2 * math.pi / n)
    for (r, y), (s, z) in zip(rings, rings[1:]):
        # bands are trapezoids between polygons; their height is that of the apothems
        slant = math.hypot((r - s) * math.cos(math.pi / n), y - z)
        area += n * math.sin(math.pi / n) * (r + s) * slant
        volume += unit * (y - z) / 3 * (r * r + r * s + s * s)
    return points, faces, area, volume


CUBE, CUBE_FACES = box()
TETRAHEDRON = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
TETRAHEDRON_FACES = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 1 + 1]]
SLOPED = 1.5 + math.sqrt(3) / 2
SQUARE = obj([(0, 0, 0), (2, 0, 0), (2, 1, 0), (0, 1, 0)], [[0, 1, 2], [0, 2, 3]])
UV = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n"


def kinds():
    """(files of the 144, name, text, what is mended, area, volume or None, pieces)."""
    yield 107, "closed, triangles", obj(TETRAHEDRON, TETRAHEDRON_FACES), "nothing", SLOPED, 1 / 6, 1
    yield 107, "closed, quads", obj(CUBE, CUBE_FACES), "nothing", 6, 1, 1
    points, faces = sheet(3, 2)
    yield (107, "open, triangles and quads", obj(points + [(0.3, 0, 0)], faces + [[2, 6, 5]]),
           "nothing", 0.025, None, 1)
    large = sheet(87, 166)
    assert len(large[0]) == 14442
    yield 107, "open, 14,442 vertices", obj(*large), "nothing", 8.6 * 16.5, None, 1
    for form in "{v}/{t}", "{v}//{n}", "{v}/{t}/{n}", "{last}":
        yield 107, "corners as " + form, UV + obj(CUBE, CUBE_FACES, form), "nothing", 6, 1, 1
    many = [box(2 * k) for k in range(5)]
    yield (107, "a row of five boxes", "".join(obj(*apart(*m[:1], [m[1]]), "{last}") for m in many),
           "nothing", 30, 5, 5)

    points, parts, area, volume = fan_cylinder(8)
    yield (107, "doubled, three pieces of a surface", obj(*apart(points, parts)),
           "16 doubled vertices welded", area, volume, 1)
    yield (107, "doubled, a tower in six pieces", obj(*apart(CUBE, [[f] for f in CUBE_FACES])),
           "16 doubled vertices welded", 6, 1, 1)
    points, parts, area, volume = fan_cylinder(75)
    soup = [[f] for part in parts for f in part]
    assert len(soup) == 300
    yield (107, "doubled, 300 triangles apart", obj(*apart(points, soup)),
           "748 doubled vertices welded", area, volume, 1)
    points, faces, area, volume = seamed_sphere(12, 6)
    yield (107, "doubled, a texture's seam with poles", obj(points, faces),
           "24 faces without area (the first in line 92) removed, 5 doubled vertices welded", area,
           volume, 1)



    grid = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1, 2)]
    halves = [[[a + k for a in f] for f in ([0, 3, 4, 1], [6, 7, 10, 9], [0, 1, 7, 6], [3, 9, 10, 4])]
              for k in (0, 1)]
    ends, wall = [[0, 6, 9, 3], [2, 5, 11, 8]], [1, 4, 10, 7]
    for name, turned, edges in ("differently", wall[::-1], 4), ("alike", wall[:1] + wall[:0:-1], 5):
        yield (18, "boxes side by side, walls cut " + name,
               obj(grid, halves[0] + [ends[0], wall] + halves[1] + [ends[1], turned]),
               f"{edges} edges of three triangles or more (the first in line 19) cut", 12, 2, 2)
    yield (18, "an inner wall", obj(grid, sum(halves, ends) + [wall]),
           "4 edges of three triangles or more (the first in line 23) cut", 11, None, 2)
    yield (18, "an ear on an edge", obj(CUBE + [(2, 2, 0.5)], CUBE_FACES + [[3, 7, 8]]),
           "1 edge of three triangles or more (line 16) cut", 6 + math.sqrt(2) / 2, None, 2)
    points = [(0, 0, 0), (0, 0, 1), (1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0)]
    solids = [[[0, 3, 2], [1, 2, 3], [0, 1, 3], [1, 0, 2]], [[0, 5, 4], [1, 4, 5], [0, 1, 5], [1, 0, 4]]]
    yield (18, "two solids on one edge", obj(points, sum(solids, [])),
           "1 edge of three triangles or more (line 13) cut", 2 * SLOPED, 1 / 3, 2)
    # the order of the file does not say which faces bound a solid
    for faces in solids[0][:3] + solids[1] + solids[0][3:], solids[1][::-1] + solids[0]:
        yield (18, "two solids on one edge, mixed", obj(points, faces),
               "1 edge of three triangles or more (line 13) cut", 2 * SLOPED, 1 / 3, 2)

    yield (8, "no area, three corners in a line",
           obj(TETRAHEDRON + [(0.5, 0, 0)], [[0, 2, 1], [0, 4, 3], [4, 1, 3], [0, 1, 4], [1, 2, 3], [0, 3, 2]]),
           "1 face without area (line 9) removed", SLOPED, 1 / 6, 1)
    yield (8, "no area, two equal corners", obj(TETRAHEDRON, TETRAHEDRON_FACES + [[0, 0, 1]]),
           "1 face without area (line 9) removed", SLOPED, 1 / 6, 1)
    yield (8, "no area, two corners in one place",
           obj(TETRAHEDRON + [(0, 0, 0)], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [4, 3, 2], [0, 3, 4], [0, 4, 2]]),
           "2 faces without area (the first in line 10) removed", SLOPED, 1 / 6, 1)
    yield (3, "a vertex in no face", obj(TETRAHEDRON + [(9, 9, 9)], TETRAHEDRON_FACES),
           "1 vertex in no face removed", SLOPED, 1 / 6, 1)

    for name, text, mended in (
            ("lines l", SQUARE + "l 1 2 3\n", "nothing"),
            ("vertex colours", re.sub("(v .*)", r"\1 0.5 0.5 0.5", SQUARE), "nothing"),
            ("a corner without vt among corners with", UV + SQUARE.replace("f 1 2 3", "f 1/1 2/2 3"),
             "nothing"),
            ("faces with vt and without", UV + SQUARE.replace("f 1 2 3", "f 1/1 2/2 3/3"), "nothing"),
            ("keywords of a cloth simulator", SQUARE.replace("f 1", "ny 0 0 0\nvl 1\nadj 1 2\nf 1"),
             "6 lines of other programs passed over (ny, vl, adj)")):
        yield 8, name, text, mended, 2, None, 1


def read(path):
    """Points and triangles of an OBJ file of the program."""
    lines = [line.split() for line in open(path)]
    return (np.array([[float(w) for w in line[1:]] for line in lines if line[0] == "v"]),
            np.array([[int(w.split("/")[0]) - 1 for w in line[1:]] for line in lines if line[0] == "f"]))


def measure(path):
    """Area, volume (None: open) and pieces of a mesh, whose edges must have one triangle or two of
    opposite direction."""
    points, faces = read(path)
    a, b, c = (points[faces[:, k]] for k in range(3))
    sides = [(f[k], f[(k + 1) % 3]) for f in faces.tolist() for k in range(3)]
    assert len(set(sides)) == len(sides), "an edge has two triangles of one direction"
    joined = list(range(len(points)))

    def root(v):
        while joined[v] != v:
            joined[v] = v = joined[joined[v]]
        return v
    for p, q in sides:
        joined[root(p)] = root(q)
    is_open = set(sides) != {(q, p) for p, q in sides}
    return (np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2,
            None if is_open else np.einsum("ij,ij", a, np.cross(b, c)) / 6,
            len({root(v) for v in range(len(points))}))


def run(*command):
    done = subprocess.run(command, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert done.returncode == 0, f"exit code {done.returncode}: {done.stderr}"
    return done


def check(program, text, mended, area, volume, pieces):
    open("m.obj", "w").write(text)
    report = run(program, "mesh", "m.obj", "-o", "n.obj", "-y").stdout
    assert f"\nmended      {mended}\n" in report, report
    assert f"\npieces      {pieces}\n" in report, report
    found = measure("n.obj")
    assert abs(found[0] / area - 1) < 1e-8 and found[2] == pieces, found
    assert found[1] is volume or abs(found[1] / volume - 1) < 1e-8, found

    # pieces in contact would be told of, so contact is with the colliders alone
    with open("s.json", "w") as scene:
        json.dump({"bodies": [{"mesh": {"file": "m.obj", "velocity": [1, 0, 0]},
                               "mass": {"areal_density": 2}}]}, scene)
    done = run(program, "run", "s.json", "-n", "0", "--no-render", "--ledger", "-", "-q")
    words = "clothsim: warning: bodies[0].mesh.file: m.obj: " + mended + "\n"
    told = [line for line in done.stderr.splitlines(True) if "pieces" not in line]
    assert told == ([] if mended == "nothing" else [words]), done.stderr
    assert abs(float(done.stdout.splitlines()[-1].split(",")[2]) / area - 1) < 1e-8, done.stdout

    with open("s.json", "w") as scene:
        json.dump({"bodies": [{"cloth": {"grid": [2, 2], "place": {"translate": [0, 99, 0]}},
                               "mass": {"total": 1}}],
                   "colliders": [{"mesh": {"file": "m.obj"}}], "contact": "force"}, scene)
    done = run(program, "run", "s.json", "-n", "0", "--no-render", "-q", "-y", "-o", "out",
               "--export", "obj")
    assert not done.stderr, done.stderr
    found = measure("out/colliders_00000.obj")
    assert abs(found[0] / area - 1) < 1e-8, found


def main():
    program, failed = os.path.realpath(sys.argv[1]), 0
    rows = list(kinds())
    print(f"1..{len(rows)}")
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for n, (files, name, *case) in enumerate(rows, 1):
            try:
                check(program, *case)
                print(f"ok {n} - {name}, of {files} files")
            except AssertionError as wrong:
                failed += 1
                print(f"not ok {n} - {name}, of {files} files\n# " + str(wrong).replace("\n", "\n# "))
    return failed > 0


if __name__ == "__main__":
    sys.exit(main())
