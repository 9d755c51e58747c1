#!/usr/bin/env python3
"""Writes scenes/disc.obj: a flat round cloth of triangles, with texture coordinates."""
import math

RINGS = 14

places = {}
for q in range(-RINGS, RINGS + 1):
    for r in range(-RINGS, RINGS + 1):
        ring = max(abs(q), abs(r), abs(q + r))
        if ring > RINGS:
            continue
        # a hexagon of triangles, its rings made round
        x, z = q + r / 2, r * math.sqrt(3) / 2
        grow = ring / math.hypot(x, z) if ring else 0
        places[q, r] = len(places) + 1, 0.5 * x * grow / RINGS, 0.5 * z * grow / RINGS

with open("scenes/disc.obj", "w") as out:
    out.write("# a round cloth of diameter 1 in the xz plane, made by tools/make_disc.py\n")
    for _, x, z in places.values():
        out.write(f"v {x:.5f} 0 {z:.5f}\n")
    for _, x, z in places.values():
        out.write(f"vt {x + 0.5:.5f} {0.5 - z:.5f}\n")
    for q, r in places:
        for other, third in (((q, r + 1), (q + 1, r)), ((q - 1, r + 1), (q, r + 1))):
            if other in places and third in places:
                a, b, c = (places[p][0] for p in ((q, r), other, third))
                out.write(f"f {a}/{a} {b}/{b} {c}/{c}\n")
