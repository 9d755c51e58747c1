#!/usr/bin/python3
"""`clothsim mesh` on binary glTF that is written here: its OBJ has area, volume and names of what
was written, and whatever byte is missing or wrong is one line or another mesh (as TAP).

usage: gltf.py PROGRAM
"""
import json
import os
import random
import struct
import subprocess
import sys
import tempfile

import numpy as np

sys.argv[1:] or sys.exit("usage: gltf.py PROGRAM")

# a cube of side 1; its lid is a primitive of its own, whose vertices stand apart
CUBE = [(k & 1, k >> 1 & 1, k >> 2) for k in range(8)]
SIDES = [0, 2, 3, 0, 3, 1, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5]
LID = [0, 1, 3, 0, 3, 2]


def glb(change=None, indices="H", version=2):
    """The bytes of a file: two nodes, the second below the first, show one mesh."""
    codes = {"B": 5121, "H": 5123, "I": 5125}
    parts = [struct.pack("<24f", *sum(CUBE, ())), struct.pack(f"<30{indices}", *SIDES),
             # positions and texture coordinates of the lid in one array of a stride of 20 bytes
             b"".join(struct.pack("<5f", *p, p[0], p[1]) for p in CUBE[4:]),
             struct.pack(f"<6{indices}", *LID)]
    views, data = [], b""
    for part, stride in zip(parts, (None, None, 20, None)):
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(part)})
        views[-1].update({"byteStride": stride} if stride else {})
        data += part + bytes(-len(part) % 4)
    accessors = [{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3"},
                 {"bufferView": 1, "componentType": codes[indices], "count": 30, "type": "SCALAR"},
                 {"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC3"},
                 {"bufferView": 2, "byteOffset": 12, "componentType": 5126, "count": 4, "type": "VEC2"},
                 {"bufferView": 3, "componentType": codes[indices], "count": 6, "type": "SCALAR"}]
    half = np.sqrt(0.5)
    root = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
            "nodes": [{"name": "big box", "mesh": 0, "scale": [2, 2, -2], "children": [1]},
                      # a quarter turn about x, then ten metres along it, in the scale of its parent
                      {"mesh": 0, "translation": [5, 0, 0], "rotation": [half, 0, 0, half]}],
            "meshes": [{"primitives": [
                {"attributes": {"POSITION": 0}, "indices": 1, "material": 0},
                {"attributes": {"POSITION": 2, "TEXCOORD_0": 3}, "indices": 4, "material": 1},
                {"attributes": {"POSITION": 0}, "mode": 1}]}],
            "materials": [{"name": "denim"}, {"name": "silk#1"}],
            "accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": len(data)}]}
    if change:
        change(root)
    text = json.dumps(root).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data
    return struct.pack("<4sII", b"glTF", version, 12 + len(chunks)) + chunks


def mesh(program, data, *rest):
    with open("m.glb", "wb") as file:
        file.write(data)
    return subprocess.run([program, "mesh", "m.glb", *rest], text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE)


def triangles(path):
    lines = [line.split() for line in open(path)]
    points = np.array([[float(w) for w in line[1:]] for line in lines if line[0] == "v"])
    return points[np.array([[int(w.split("/")[0]) - 1 for w in line[1:]] for line in lines if line[0] == "f"])]


def placed(program):
    """Two cubes of side 2: one below the origin, mirrored, one turned and moved by the other's."""
    for indices in "BHI":
        done = mesh(program, glb(indices=indices), "-o", "n.obj", "-y")
        assert not done.returncode, done.stderr
        for line in ("vertices    16, in the file 24", "pieces      2", "mended      8 doubled vertices welded",
                     "group       big_box, 12 triangles", "material    denim, 20 triangles",
                     "material    silk_1, 4 triangles"):
            assert line + "\n" in done.stdout, done.stdout
        a, b, c = np.moveaxis(triangles("n.obj"), 1, 0)
        assert abs(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2 - 48) < 1e-5
        # a mirrored solid keeps its outside
        assert abs(np.einsum("ij,ij", a, np.cross(b, c)) / 6 - 16) < 1e-5
        every = np.concatenate([a, b, c])
        for cube, low, high in ((every[:, 0] < 5, (0, 0, -2), (2, 2, 0)),
                                (every[:, 0] > 5, (10, -2, -2), (12, 0, 0))):
            assert np.allclose(every[cube].min(0), low, atol=1e-6), every[cube].min(0)
            assert np.allclose(every[cube].max(0), high, atol=1e-6), every[cube].max(0)


def by_matrix(program):
    """A matrix stands by columns; indices may be absent."""
    def change(root):
        root["nodes"] = [{"mesh": 0, "matrix": [0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 1, 2, 3, 1]}]
        root["meshes"][0]["primitives"] = [{"attributes": {"POSITION": 0}}]
        root["accessors"][0]["count"] = 3
    done = mesh(program, glb(change), "-o", "n.obj", "-y")
    assert not done.returncode, done.stderr
    assert triangles("n.obj").tolist() == [[[1, 2, 3], [1, 4, 3], [-1, 2, 3]]]


def in_a_scene(program):
    with open("s.json", "w") as scene:
        scene.write('{"bodies": [{"mesh": {"file": "%s"}, "mass": {"total": 1}}]}')
    mesh(program, glb(), "-o", "n.obj", "-y")
    for name, words in ("n.obj", "ok, 16 particles"), ("m.glb", "found glTF, expected OBJ"):
        with open("s.json", "w") as scene:
            json.dump({"bodies": [{"mesh": {"file": name}, "mass": {"total": 1}}]}, scene)
        done = subprocess.run([program, "scene", "s.json"], text=True, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT)
        assert words in done.stdout, done.stdout


def set_at(*path, value):
    def change(root):
        for key in path[:-1]:
            root = root[key]
        root[path[-1]] = value
    return change


def malformed(program):
    primitive = "meshes", 0, "primitives", 0
    cases = [glb(version=1), glb()[:40], glb()[:-4], b"glTF", b"glTF" + bytes(16)]
    cases += [glb(set_at(*path, value=value)) for path, value in (
        (("accessors", 0, "count"), 9), (("accessors", 0, "count"), 4294967295), (("accessors", 0, "count"), 0),
        (("accessors", 0, "count"), 1e300), (("accessors", 0, "byteOffset"), -1), (("accessors", 0, "sparse"), {}),
        (("accessors", 0, "type"), "VEC4"), (("accessors", 1, "componentType"), 5126),
        (("accessors", 0, "componentType"), 5123), (("bufferViews", 0, "byteOffset"), 4294967294),
        (("bufferViews", 0, "byteStride"), 4), (("bufferViews", 0, "buffer"), 1), (("bufferViews",), []),
        (("accessors", 0, "bufferView"), "x"), (("nodes", 1, "children"), [0]), (("nodes", 0, "children"), [0]),
        (("nodes", 0, "children"), [7]), (("nodes", 0, "children"), [-1]), (("nodes", 0, "scale"), [1, 2]),
        (("nodes", 0, "scale"), [1, 2, "3"]), (("scenes", 0, "nodes"), []), (("scene",), 3),
        ((*primitive, "mode"), 5), ((*primitive, "indices"), 99), ((*primitive, "attributes"), []))]
    for k, data in enumerate(cases):
        done = mesh(program, data)
        assert done.returncode == 4 and done.stderr.count("\n") == 1 and not done.stdout, (k, done)
        assert done.stderr.startswith("clothsim: m.glb: found "), (k, done.stderr)


def damaged(program):
    """Bytes that are changed by chance: a mesh, or one line."""
    chance = random.Random(1)
    for _ in range(60):
        data = bytearray(glb())
        for _ in range(chance.randrange(1, 4)):
            data[chance.randrange(4, len(data))] = chance.choice((0, 255, 128, 57, chance.randrange(256)))
        done = mesh(program, bytes(data))
        assert done.returncode in (0, 4), (done, bytes(data))
        assert done.stderr.count("\n") == (done.returncode == 4), done


def main():
    program, failed = os.path.realpath(sys.argv[1]), 0
    tests = [placed, by_matrix, in_a_scene, malformed, damaged]
    print(f"1..{len(tests)}")
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for n, test in enumerate(tests, 1):
            try:
                test(program)
                print(f"ok {n} - {test.__name__}")
            except AssertionError as wrong:
                failed += 1
                print(f"not ok {n} - {test.__name__}\n# {wrong}")
    return failed > 0


if __name__ == "__main__":
    sys.exit(main())
