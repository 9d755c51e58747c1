#!/usr/bin/env python3
"""Writes the scenes of scenes/hard, in which contact is fast, thin or sharp, and their meshes: a
star of spikes, needles, and a tube whose ends turn on chords."""
import json
import math

from make_meshes import ring, wall, write

SPRINGS = {"stretch": 100, "shear": 30, "bend": 1, "damping": 0.01}
THIN = 0.002


def cloth(n, size, place, start="flat", **keys):
    body = {"cloth": {"grid": [n, n], "size": [size, size], "start": start, "place": place}}
    body["cloth"].update({k: keys.pop(k) for k in ("velocity",) if k in keys})
    return body | {"mass": {"areal_density": 0.2}, "springs": SPRINGS, "thickness": THIN,
                   "self_contact": True, "friction": 0.3} | keys


def star():
    """spikes of length 0.14 on the corners of an icosahedron of radius 0.06"""
    g = (1 + math.sqrt(5)) / 2
    corners = [(0, a, b * g) for a in (-1, 1) for b in (-1, 1)]
    corners = corners + [(b, c, a) for a, b, c in corners] + [(c, a, b) for a, b, c in corners]
    length = math.sqrt(1 + g * g)
    near = lambda a, b: abs(math.dist(corners[a], corners[b]) - 2) < 1e-9
    faces = [(a, b, c) for a in range(12) for b in range(a) for c in range(b)
             if near(a, b) and near(b, c) and near(a, c)]
    places = [tuple(0.06 * q / length for q in p) for p in corners]
    triangles = []
    for a, b, c in faces:
        p, q, r = (corners[i] for i in (a, b, c))
        u, v = [y - x for x, y in zip(p, q)], [y - x for x, y in zip(p, r)]
        cross = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
        if sum(x * y for x, y in zip(cross, p)) < 0:
            b, c = c, b
        middle = [sum(t) for t in zip(p, q, r)]
        out = 0.2 / math.hypot(*middle)
        triangles += [(a, b, len(places)), (b, c, len(places)), (c, a, len(places))]
        places.append(tuple(out * m for m in middle))
    write("hard/star", "20 spikes on an icosahedron", places, triangles)


def needles():
    places, triangles = [], []
    for i in range(5):
        for j in range(5):
            x, z, first = 0.1 * (i - 2), 0.1 * (j - 2), len(places)
            places += ring(0.012, 0, 5, x, z) + [(x, 0.2, z)]
            triangles += [(first + k, first + 5, first + (k + 1) % 5) for k in range(5)]
    write("hard/needles", "5 x 5 needles of five sides, open below", places, triangles)


AROUND, ALONG, RADIUS, LENGTH = 24, 30, 0.1, 0.6


def tube():
    places = [p for k in range(ALONG)
              for p in ring(RADIUS, LENGTH * (k / (ALONG - 1) - 0.5), AROUND)]
    triangles = [t for k in range(ALONG - 1) for t in wall(k * AROUND, AROUND, True)]
    write("hard/tube", "a tube, open at both ends", places, triangles)


def turn(particle, angle, sign):
    """a grab that turns one particle of an end by two turns in 2 s, on chords of 30 degrees"""
    path = []
    for k in range(1, 25):
        a = angle + sign * k * math.pi / 6
        path.append({"at": round(k / 12, 9), "point": [
            round(RADIUS * (math.cos(a) - math.cos(angle)), 9), 0,
            round(RADIUS * (math.sin(a) - math.sin(angle)), 9)]})
    return {"from": 0, "to": 2, "grab": {"particles": [particle], "relative": True, "path": path}}


def grab(to, start, end, path, **keys):
    return {"from": start, "to": end, "grab": {
        "body": 0, "particles": [to], "relative": True, "path": path} | keys}


def twist():
    events = []
    for k in range(AROUND):
        angle = 2 * math.pi * k / AROUND
        events += [turn(k, angle, 1), turn((ALONG - 1) * AROUND + k, angle, -1)]
    return {"bodies": [{"mesh": {"file": "tube.obj"}, "mass": {"areal_density": 0.2},
                        "springs": {"stretch": 100, "bend": 1, "damping": 0.01}, "thickness": THIN, "self_contact": True,
                        "friction": 0.3}],
            "forces": {"gravity": [0, 0, 0]}, "events": events}


def scenes():
    sheet = lambda y, **keys: cloth(40, 0.6, {"translate": [0.01, y, 0.02]}, **keys)
    thrown = lambda y, v, turned: cloth(
        32, 0.5, {"translate": [0, y, 0]} | ({"rotate": turned} if turned else {}), velocity=v)
    floor = {"floor": {"height": 0}, "friction": 0.3, "thickness": THIN}
    move = lambda point, at, **keys: [{"from": 0, "to": at, "move": {
        "collider": 0, "path": [{"at": at, "point": point}]} | keys}]
    quarter = [0.7071067812, 0, 0, 0.7071067812]
    ball = {"mesh": {"shape": "sphere", "detail": 5, "scale": [0.1, 0.1, 0.1],
                     "place": {"translate": [0, 0.054, 0]}},
            "network": {"placement": "opposed-normals", "springs": 4, "surface": 4, "seed": 3},
            "mass": {"total": 0.2}, "springs": {"stretch": 400, "bend": 0, "damping": 0.05},
            "thickness": THIN, "material": {"colour": [0.6, 0.45, 0.1]}}
    return {
        "star": ("A sheet falls on a star of spikes, folds over it and rests on points and edges.",
                 {"bodies": [sheet(0.45)], "colliders": [
                     {"mesh": {"file": "star.obj", "place": {"translate": [0, 0.2, 0]}},
                      "friction": 0.3, "thickness": THIN}, floor]}),
        "needles": ("A sheet falls on needles that are sharper than its cells.",
                    {"bodies": [sheet(0.25)], "colliders": [
                        {"mesh": {"file": "needles.obj"}, "friction": 0.1, "thickness": THIN}, floor]}),
        "ring": ("A sheet is pulled by its middle through a ring of a sixth of its width.",
                 {"bodies": [cloth(41, 0.6, {"translate": [0, 0.06, 0]})], "colliders": [
                     {"mesh": {"shape": "torus", "detail": 24, "scale": [0.2, 0.2, 0.2],
                               "place": {"rotate": quarter}},
                      "friction": 0.2, "thickness": THIN}],
                  "events": [grab(840, 0, 2, [{"at": 2, "point": [0, -0.7, 0]}])]}),
        "clash": ("Two sheets are thrown at each other at 10 m/s each.",
                  {"bodies": [thrown(0.2, [0, -10, 0], None),
                              thrown(-0.2, [0, 10, 0], [0, 0.3826834324, 0, 0.9238795325])],
                   "pairs": {"among": "all", "friction": 0.3}}),
        "crash": ("A sheet is thrown edge-on at 10 m/s on one that hangs.",
                  {"bodies": [cloth(32, 0.5, {"translate": [0, 0, 0]}, start="hanging",
                                    pins=["top"]),
                              cloth(32, 0.5, {"translate": [0.02, 0.03, 0.5]},
                                    velocity=[0, 0, -10])],
                   "pairs": {"among": "all", "friction": 0.3}}),
        "bullet": ("A ball goes through where a curtain hangs, at 10 m/s.",
                   {"bodies": [cloth(32, 0.8, {"translate": [0, 0, 0]}, start="hanging",
                                     pins=["top"])],
                    "colliders": [{"mesh": {"shape": "sphere", "detail": 5,
                                            "scale": [0.25, 0.25, 0.25],
                                            "place": {"translate": [0.01, -0.1, 0.3]}},
                                   "friction": 0.3, "thickness": THIN}],
                    "events": move([0, 0, -2], 0.2)}),
        "roller": ("A ball that turns takes a sheet along by friction of 0.8.",
                   {"bodies": [cloth(40, 0.8, {"translate": [0.01, 0.42, 0.02]}, friction=0.8)],
                    "colliders": [{"mesh": {"shape": "sphere", "detail": 6,
                                            "scale": [0.4, 0.4, 0.4],
                                            "place": {"translate": [0, 0.2, 0]}},
                                   "friction": 0.8, "thickness": THIN}, floor],
                    "events": [{"from": 0.5, "to": 3,
                                "move": {"collider": 0, "spin": [0, 6.283185307, 0]}}]}),
        "tube": ("A tube is twisted by two turns at each end, and winds up on itself.", twist()),
        "pull": ("A cloth is pulled from under two soft balls at 3 m/s.",
                 {"bodies": [cloth(40, 0.6, {"translate": [0, 0.003, 0]}), ball,
                             json.loads(json.dumps(ball | {"material": {"colour": [0.2, 0.4, 0.75]}}).replace(
                                 "[0, 0.054, 0]", "[-0.15, 0.054, 0.1]"))],
                  "camera": {"eye": [0.15, 0.55, 1.2], "target": [0.15, 0, 0]},
                  "colliders": [floor], "pairs": {"among": "all", "friction": 0.3},
                  "events": [grab("right", 0.3, 0.7, [{"at": 0.7, "point": [1.2, 0, 0]}])]}),
    }


def more():
    """ten that no number of the program was chosen by"""
    sheet = lambda y, **keys: cloth(32, 0.6, {"translate": [0.01, y, 0.02]}, **keys)
    floor = {"floor": {"height": 0}, "friction": 0.3, "thickness": THIN}
    mesh = lambda shape, scale, at, turn=(0, 0, 0, 1): {
        "mesh": {"shape": shape, "scale": scale, "place": {"translate": at, "rotate": list(turn)}}}
    hard = {"friction": 0.3, "thickness": THIN}
    soft = {"network": {"placement": "opposed-normals", "springs": 4, "surface": 4, "seed": 3},
            "mass": {"total": 0.2}, "springs": {"stretch": 400, "bend": 0, "damping": 0.05},
            "thickness": THIN}
    moved = lambda k, to, **path: {"from": 0, "to": to, "move": {"collider": k} | path}
    tip = (0.2798, 0.1159, 0.3647, 0.8805)
    ringed = lambda x, turn: mesh("torus", [0.2, 0.2, 0.2], [x, 0, 0], turn) | soft | {
        "mass": {"total": 0.1}, "springs": {"stretch": 800, "bend": 0, "damping": 0.05}}
    return {
        "corner": ("A sheet falls by a metre on the corner of a box.",
                   {"bodies": [sheet(1.3)],
                    "colliders": [mesh("box", [0.25, 0.25, 0.25], [0, 0.22, 0], tip) | hard, floor]}),
        "wires": ("A sheet is thrown at 5 m/s on two crossed wires of 3 mm.",
                  {"bodies": [sheet(0.5, velocity=[0, -5, 0])], "colliders": [
                      {"capsule": {"from": [-0.5, 0.3, 0], "to": [0.5, 0.3, 0], "radius": 0.0015}} | hard,
                      {"capsule": {"from": [0, 0.29, -0.5], "to": [0, 0.29, 0.5], "radius": 0.0015}} | hard,
                      floor]}),
        "press": ("A folded sheet is pressed flat between two plates.",
                  {"bodies": [sheet(0.15)], "colliders": [
                      mesh("box", [0.4, 0.1, 0.4], [0, 0.05, 0]) | hard,
                      mesh("box", [0.38, 0.1, 0.38], [0.01, 0.26, 0]) | hard],
                   "events": [moved(1, 0.5, path=[{"at": 0.5, "point": [0, -0.1, 0]}])]}),
        "whip": ("A corner of a hanging sheet is led at up to 20 m/s to and fro.",
                 {"bodies": [cloth(32, 0.6, {"translate": [0, 0, 0]}, start="hanging", pins=["top-left"])],
                  "events": [grab("bottom-right", 0, 0.3, [
                      {"at": 0.04, "point": [-0.3, 0.2, 0.5]}, {"at": 0.1, "point": [-0.4, 0.2, -0.5]},
                      {"at": 0.15, "point": [-0.2, 0.3, 0.4]}, {"at": 0.3, "point": [-0.5, 0.4, 0]}])]}),
        "stack": ("Ten sheets fall on one another and on a floor.",
                  {"bodies": [cloth(12, 0.3, {"translate": [0.002 * (k % 3), 0.01 + 0.006 * k, 0.003 * (k % 2)]})
                              for k in range(10)],
                   "colliders": [floor], "pairs": {"among": "all", "friction": 0.3}}),
        "hammock": ("A bear falls into a sheet that is held by its corners.",
                    {"bodies": [sheet(0.5, pins=["top-left", "top-right", "bottom-left", "bottom-right"]),
                                mesh("limbs", [0.25, 0.25, 0.25], [0, 0.8, 0]) | soft],
                     "pairs": {"among": "all", "friction": 0.3}}),
        "knife": ("A blade comes down at 5 m/s on the middle of a sheet held at two edges.",
                  {"bodies": [sheet(0.3, pins=["left", "right"])],
                   "colliders": [mesh("box", [0.004, 0.2, 0.3], [0.01, 0.45, 0.02]) | hard],
                   "events": [moved(0, 0.1, path=[{"at": 0.04, "point": [0, -0.2, 0]}])]}),
        "links": ("Two rings, one through the other, hang by some points of the first.",
                  {"bodies": [ringed(0, (0, 0, 0, 1)) | {"pins": [0, 1, 2, 3]},
                              ringed(0.07, (0.7071067812, 0, 0, 0.7071067812))],
                   "pairs": {"among": "all", "friction": 0.3}}),
        "spin": ("A sheet that turns at 30 rad/s falls on a floor.",
                 {"bodies": [sheet(0.05) | {"cloth": {"grid": [32, 32], "size": [0.6, 0.6], "start": "flat",
                                                      "place": {"translate": [0, 0.05, 0]}, "spin": [0, 30, 0]}}],
                  "colliders": [floor]}),
        "net": ("A soft ball is thrown at 10 m/s into a sheet held at its edges.",
                {"bodies": [cloth(32, 0.6, {"translate": [0, 0, 0]}, start="hanging", pins=["edges"]),
                            mesh("sphere", [0.15, 0.15, 0.15], [0.02, 0.01, 0.4]) | soft],
                 "pairs": {"among": "all", "friction": 0.3}}),
    }


def lines(value):
    """one line, or one for each object of a list"""
    if not (isinstance(value, list) and isinstance(value[0], dict)):
        return json.dumps(value)
    return "[\n    " + ",\n    ".join(json.dumps(v) for v in value) + "\n  ]"


def main():
    star(), needles(), tube()
    for name, (about, keys) in (scenes() | more()).items():
        scene = {"about": about} | keys
        scene.setdefault("contact", "force")
        with open(f"scenes/hard/{name}.json", "w") as out:
            out.write("{\n" + ",\n".join(f'  "{k}": {lines(v)}' for k, v in scene.items()) + "\n}\n")


if __name__ == "__main__":
    main()
