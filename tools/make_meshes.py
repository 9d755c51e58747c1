#!/usr/bin/env python3
"""Writes the meshes of scenes that bodies meet: scenes/funnel.obj, scenes/needles.obj,
scenes/tetrahedron.obj, scenes/bight.obj, a ribbon that is half a reef knot, and the tube
scenes/twister.obj with scenes/twister.json, whose ends turn on chords."""
import json
import math


def write(name, head, places, triangles):
    with open(f"scenes/{name}.obj", "w") as out:
        out.write(f"# {head}, made by tools/make_meshes.py\n")
        for p in places:
            out.write("v %.6g %.6g %.6g\n" % tuple(c + 0.0 for c in p))
        for t in triangles:
            out.write("f %d %d %d\n" % tuple(i + 1 for i in t))


def ring(radius, y, n, x=0.0, z=0.0):
    angles = [2 * math.pi * k / n for k in range(n)]
    return [(x + radius * math.cos(a), y, z + radius * math.sin(a)) for a in angles]


def wall(lower, n, outwards):
    """triangles between a ring of n points from `lower` on and the next one"""
    found = []
    for k in range(n):
        a, b = lower + k, lower + (k + 1) % n
        found += [(a, a + n, b), (b, a + n, b + n)]
    return found if outwards else [(a, c, b) for a, b, c in found]


def funnel():
    n = 24
    rings = [(0.42, 0.30), (0.32, 0.18), (0.22, 0.06), (0.13, -0.05), (0.11, -0.16), (0.11, -0.30)]
    places = [p for radius, y in rings for p in ring(radius, y, n)]
    triangles = [t for i in range(len(rings) - 1) for t in wall(i * n, n, False)]
    write("funnel", "a cone above a tube, open at both ends", places, triangles)


def needles():
    places, triangles = [], []
    for i in range(10):
        for j in range(10):
            x, z, first = 0.07 * (i - 4.5), 0.07 * (j - 4.5), len(places)
            places += ring(0.018, 0, 6, x, z) + ring(0.0099, 0.096, 6, x, z) + [(x, 0.16, z)]
            triangles += wall(first, 6, True)
            triangles += [(first + 6 + k, first + 12, first + 6 + (k + 1) % 6) for k in range(6)]
    write("needles", "10 x 10 cones of six sides, open below", places, triangles)


def tetrahedron():
    places = [(0, -0.16, 0)] + ring(0.1, 0.04, 3)
    write("tetrahedron", "a tetrahedron, tip down", places,
          [(0, 1, 2), (0, 2, 3), (0, 3, 1), (1, 3, 2)])


# the reef knot: each bight goes over the other's strands where it turns, and under them before
NARROW, WIDE, TURN, HEIGHT, LEAD = 0.028, 0.075, 0.075, 0.016, 0.42


def smooth(t):
    t = min(max(t, 0), 1)
    return t * t * (3 - 2 * t)


def height(x):
    if x < -TURN:
        return HEIGHT * (1 - smooth((-x - 2.2 * TURN) / (1.5 * TURN)))
    return HEIGHT * math.cos(math.pi * (x + TURN) / TURN) if x < TURN else HEIGHT


def centre_line():
    middle, reach = 0.7 * TURN, 0.75 * TURN
    xs = [-LEAD + (middle + LEAD) * k / 400 for k in range(400)]
    strand = [(x, NARROW + (WIDE - NARROW) * smooth((x + TURN) / (1.7 * TURN))) for x in xs]
    angles = [math.pi / 2 - math.pi * k / 200 for k in range(201)]
    bend = [(middle + reach * math.cos(a), WIDE * math.sin(a)) for a in angles]
    line = strand + bend + [(x, -y) for x, y in reversed(strand)]
    return [(x, y, height(x)) for x, y in line]


def bight():
    points, half, line, along = 121, 0.0085, centre_line(), [0.0]
    for p, q in zip(line, line[1:]):
        along.append(along[-1] + math.dist(p, q))

    def at(s):
        i = next((k for k in range(1, len(along)) if along[k] >= s), len(along) - 1)
        share = (s - along[i - 1]) / (along[i] - along[i - 1])
        return [p + share * (q - p) for p, q in zip(line[i - 1], line[i])]

    places, triangles = [], []
    for k in range(points):
        s = along[-1] * k / (points - 1)
        p, before, after = at(s), at(max(s - 4e-3, 0)), at(min(s + 4e-3, along[-1]))
        x, y = after[0] - before[0], after[1] - before[1]
        length = math.hypot(x, y)
        places += [(p[0] - j * half * y / length, p[1] + j * half * x / length, p[2])
                   for j in (-1, 0, 1)]
    for k in range(points - 1):
        for a in (3 * k, 3 * k + 1):
            triangles += [(a, a + 3, a + 1), (a + 1, a + 3, a + 4)]
    write("bight", "a ribbon of 121 x 3 points, half a reef knot", places, triangles)


# the twister: both ends turn at SPIN degrees/s against each other, and come inwards
AROUND, RINGS, RADIUS, LENGTH, SPIN, INWARDS, CHORD, END = 24, 25, 0.25, 1.0, 72, 0.005, 15, 6.25


def turned(k, degrees):
    angle = 2 * math.pi * k / AROUND + math.radians(degrees)
    return [RADIUS * math.cos(angle), RADIUS * math.sin(angle)]


def grab(first, k, sign):
    points = []
    for chord in range(1, round(SPIN * END / CHORD) + 1):
        t, start = chord * CHORD / SPIN, turned(k, 0)
        now = turned(k, sign * chord * CHORD)
        shift = [sign * INWARDS * t, now[0] - start[0], now[1] - start[1]]
        points.append({"at": float("%.9g" % t), "point": [float("%.6g" % c) for c in shift]})
    return {"from": 0, "to": END,
            "grab": {"particles": [first + k], "relative": True, "path": points}}


def twister():
    places = [tuple([LENGTH * (j / (RINGS - 1) - 0.5)] + turned(k, 0))
              for j in range(RINGS) for k in range(AROUND)]
    triangles = []
    for j in range(RINGS - 1):
        for k in range(AROUND):
            a, b = j * AROUND + k, j * AROUND + (k + 1) % AROUND
            c, d = a + AROUND, b + AROUND
            triangles += [(a, b, c), (b, d, c)] if (j + k) % 2 else [(a, d, c), (a, b, d)]
    write("twister", "a tube, open at both ends", places, triangles)
    events = [grab(0, k, 1) for k in range(AROUND)]
    events += [grab(AROUND * (RINGS - 1), k, -1) for k in range(AROUND)]
    with open("scenes/twister.json", "w") as out:
        out.write(TWISTER % ",\n    ".join(json.dumps(event) for event in events))


TWISTER = """{
  "about": "A tube of cloth is twisted from both ends: from about one turn on it winds up on itself.",
  "source": "after Li, Kaufman, Jiang 2021 (Codimensional IPC): both ends of a cylinder turn at 72 degrees a second and come inwards at 5 mm/s, frames of 40 ms; offset 1.5 mm there, 10 mm here for coarser triangles",
  "time": { "fps": 25 },
  "bodies": [
    {
      "mesh": { "file": "twister.obj" },
      "mass": { "areal_density": 0.15 },
      "springs": { "stretch": 60, "bend": 1, "damping": 0.02 },
      "thickness": 0.01, "self_contact": true,
      "material": { "colour": [0.45, 0.08, 0.1], "back_colour": [0.55, 0.42, 0.15] }
    }
  ],
  "contact": { "law": "force", "stiffness": 1000, "damping": 0.0005, "friction_speed": 0.01 },
  "forces": { "gravity": [0, 0, 0], "drag": 2e-4 },
  "events": [
    %s
  ],
  "crossings": "limit",
  "camera": { "eye": [0.2, 0.45, 1.5], "target": [0, 0, 0] },
  "integrator": { "name": "implicit-linearised", "dt": 0.004 }
}
"""

if __name__ == "__main__":
    funnel()
    needles()
    tetrahedron()
    bight()
    twister()
