#!/usr/bin/python3
"""Reads every file that `run --export` writes, sample by sample, and holds it to the states of the
same run, to the scene and to the other files (as TAP).

usage: exports.py PROGRAM          by parsers of its own, on small scenes
       exports.py PROGRAM vtk      by meshio and VTK, on three of the project's
"""
import json
import os
import re
import signal
import struct
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree
import zipfile

import numpy as np

sys.argv[1:] or sys.exit("usage: exports.py PROGRAM")

ALL = ["--export", "obj,pc2,vtp,npz", "--export-values", "force,strain"]

# a sheet, a soft ball without texture coordinates, a thread, and a mesh with a seam; every kind of
# collider, of which one moves and turns and one is not seen
MIXED = {
    "bodies": [
        {"cloth": {"grid": [5, 4], "size": [0.8, 0.6], "start": "flat"}, "mass": {"total": 0.2},
         "springs": {"stretch": 50, "shear": 0, "bend": 0}},
        {"mesh": {"shape": "sphere", "detail": 3, "scale": [0.2, 0.2, 0.2],
                  "place": {"translate": [1, 0.6, 0]}}, "mass": {"total": 0.3}},
        {"cloth": {"grid": [7, 1], "size": [0.6, 0.1], "place": {"translate": [-1, 0.6, 0]}},
         "mass": {"total": 0.1}, "pins": ["top-left"]},
        {"mesh": {"file": "seam.obj", "place": {"translate": [0, 1.2, 0]}}, "mass": {"total": 0.1}}],
    "colliders": [
        {"floor": {"height": -1, "extent": 3}}, {"sphere": {"centre": [0, -0.3, 0], "radius": 0.15}},
        {"box": {"centre": [1, 0.2, 0], "size": [0.4, 0.2, 0.3], "radius": 0.02}},
        {"capsule": {"from": [-1.2, 0, 0], "to": [-0.8, 0, 0.1], "radius": 0.08}},
        {"sphere": {"centre": [5, 0, 0], "radius": 0.1}, "visible": False}],
    "events": [{"from": 0, "to": 0.1, "move": {"collider": 2, "spin": [0, 20, 0],
                                               "path": [{"at": 0.1, "point": [0, -0.5, 0]}]}}],
    "time": {"fps": 50}, "integrator": {"name": "implicit-linearised"},
}
SEAM = """v 0 0 0\nv 0.2 0 0\nv 0.2 0.2 0\nv 0 0.2 0\nv 0.4 0.2 0
vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 0.25 0.5
f 1/1 2/2 3/3\nf 1/1 3/3 4/4\nf 2/5 5/2 3/3\n"""
# a mesh that moves, beneath a thread alone
THREAD = {
    "bodies": [{"cloth": {"grid": [1, 5], "size": [0.1, 0.4]}, "mass": {"total": 0.1},
                "pins": ["top"]}],
    "colliders": [{"mesh": {"shape": "box", "detail": 3, "scale": [0.2, 0.2, 0.2],
                            "place": {"translate": [0, -2, 0]}}}],
    "contact": {"law": "force"},
    "events": [{"from": 0, "to": 1, "move": {"collider": 0,
                                             "path": [{"at": 1, "point": [1, 0, 0]}]}}],
}
# no collider at all: nothing of one is written
ALONE = {"bodies": [{"cloth": {"grid": [3, 3]}, "mass": {"total": 0.1}}]}


def run(program, scene, *rest, code=0):
    done = subprocess.run([program, "run", scene, "--no-render", "-q", *rest], text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert done.returncode == code, f"exit code {done.returncode}: {done.stderr}"
    return done.stdout


def read_obj(path):
    """Places, corners, their texture coordinates (NaN: none), lines, and triangles of groups."""
    places, uvs, corners, of_corner, lines, groups = [], [], [], [], [], {}
    for line in open(path):
        kind, *words = line.split()
        if kind == "v":
            places.append([float(w) for w in words])
        elif kind == "vt":
            uvs.append([float(w) for w in words])
        elif kind == "g":
            group = words[0]
            groups[group] = 0
        elif kind == "l":
            lines.append([int(w) - 1 for w in words])
        elif kind == "f":
            pairs = [w.split("/") for w in words]
            corners.append([int(p[0]) - 1 for p in pairs])
            of_corner.append([uvs[int(p[1]) - 1] if len(p) > 1 else [np.nan] * 2 for p in pairs])
            groups[group] += 1
        else:
            assert kind == "#", line
    return (np.array(places).reshape(-1, 3), np.array(corners, int).reshape(-1, 3),
            np.array(of_corner).reshape(-1, 3, 2), np.array(lines, int).reshape(-1, 2), groups)


def read_vtp(path):
    """The arrays of a file, by name; connectivity and offsets with the kind of cell before."""
    data = open(path, "rb").read()
    head, raw = data.split(b'<AppendedData encoding="raw">\n_', 1)
    tree = xml.etree.ElementTree.fromstring(head + b"</VTKFile>")
    piece, found, end = tree.find("PolyData/Piece"), {}, 0
    for parent in [tree.find("PolyData/FieldData"), *piece]:
        for array in parent:
            at = int(array.get("offset"))
            assert at == end, "arrays follow each other"
            length, = struct.unpack_from("<Q", raw, at)
            end = at + 8 + length
            kind = {"Float64": "<f8", "Float32": "<f4", "Int32": "<i4"}[array.get("type")]
            values = np.frombuffer(raw[at + 8:end], kind)
            columns = int(array.get("NumberOfComponents", 1))
            name = array.get("Name")
            name = parent.tag + "." + name if parent.tag in ("Lines", "Polys") else name
            found[name] = values.reshape(-1, columns) if columns > 1 else values
    assert raw[end:] == b"\n</AppendedData>\n</VTKFile>\n"
    assert len(found["position"]) == int(piece.get("NumberOfPoints"))
    return found


def read_pc2(path):
    data = open(path, "rb").read()
    name, version, n, start, rate, samples = struct.unpack_from("<12siiffi", data)
    assert (name, version, start) == (b"POINTCACHE2\0", 1, 0)
    return rate, np.frombuffer(data[32:32 + 12 * n * samples], "<f4").reshape(samples, n, 3)


def read_pvd(path):
    """(time, part, file) of each data set."""
    sets = xml.etree.ElementTree.parse(path).getroot().find("Collection")
    return [(float(s.get("timestep")), int(s.get("part")), s.get("file")) for s in sets]


def check_files(folder, every, fps):
    """All formats say the same of every sample; returns the archive."""
    assert zipfile.ZipFile(folder + "/run.npz").testzip() is None
    run_, samples = np.load(folder + "/run.npz"), range(len(np.load(folder + "/run.npz")["times"]))
    assert (run_["frames"] == every * np.arange(len(samples))).all()
    assert (run_["times"] == run_["frames"] / fps).all()
    entries = [(run_["times"][k], 0, f"bodies_{k:05}.vtp") for k in samples]
    for skin, item, pre in ("bodies", "body", ""), ("colliders", "collider", "collider_"):
        if pre + "positions" not in run_:
            assert not [f for f in os.listdir(folder) if f.startswith(skin)]
            continue
        places, faces = run_[pre + "positions"], run_[pre + "faces"]
        numbers = run_["colliders"] if pre else range(len(run_["body_offsets"]) - 1)
        firsts = run_[pre + "face_offsets" if pre else "face_offsets"]
        expected = {f"{item}_{b}": firsts[k + 1] - firsts[k] for k, b in enumerate(numbers)}
        offsets = run_["collider_offsets" if pre else "body_offsets"]
        owner = np.repeat(numbers, np.diff(offsets))
        for k in range(len(places)):
            at, corners, uv, lines, groups = read_obj(f"{folder}/{skin}_{k:05}.obj")
            assert np.allclose(at, places[k], rtol=1e-8, atol=0) and (corners == faces).all()
            assert groups == expected
            vtp = read_vtp(f"{folder}/{skin}_{k:05}.vtp")
            assert (vtp["position"] == places[k]).all() and vtp["TimeValue"] == run_["times"][k]
            assert (vtp["Polys.connectivity"].reshape(-1, 3) == faces).all()
            assert (vtp["Polys.offsets"] == 3 * np.arange(1, len(faces) + 1)).all()
            assert (vtp[item] == owner).all()
            if not pre:
                assert (lines == run_["lines"]).all()
                assert "uv" not in run_ or np.array_equal(uv.astype("f4"), run_["uv"], True)
                if "uv" in run_:
                    # at each corner but those of a seam
                    off = np.nan_to_num(vtp["uv"][faces] - run_["uv"]).any(axis=(1, 2))
                    assert list(np.flatnonzero(off)) == ([206] if len(faces) == 207 else [])
                assert (vtp["Lines.connectivity"].reshape(-1, 2) == lines).all()
                for one, many in ("velocity", "velocities"), ("force", "forces"), ("strain", "strains"), \
                        ("stitches", "stitch_counts"):
                    assert (one in vtp) == (many in run_)
                    assert one not in vtp or (vtp[one] == run_[many][k]).all()
        assert not os.path.exists(f"{folder}/{skin}_{len(places):05}.obj")
        moves = len(places) == len(samples)
        assert os.path.exists(f"{folder}/{skin}.pc2") == moves
        if moves:
            rate, cache = read_pc2(f"{folder}/{skin}.pc2")
            assert rate == every and np.array_equal(cache, places.astype("f4"))
        if pre:
            entries += [(run_["times"][k], 1, f"{skin}_{k if moves else 0:05}.vtp") for k in samples]
    assert read_pvd(folder + "/run.pvd") == sorted(entries)
    return run_


def check_states(archive, folder, every=1):
    for k in range(len(archive["times"])):
        for key, name in ("positions", "x"), ("velocities", "v"):
            assert (archive[key][k] == np.load(f"{folder}/{name}_{every * k:05}.npy")).all()


def volume_of(archive, number, sample=0):
    """m3 of a collider's mesh, which must be closed and turned outwards."""
    item = list(archive["colliders"]).index(number)
    first, end = archive["collider_face_offsets"][item:item + 2]
    faces, places = archive["collider_faces"][first:end], archive["collider_positions"][sample]
    from_, to = faces.ravel().astype(int), np.roll(faces, -1, axis=1).ravel().astype(int)
    there, n = np.unique(from_ << 32 | to, return_counts=True)
    assert (n == 1).all() and (there == np.unique(to << 32 | from_)).all(), "each edge once each way"
    a, b, c = (places[faces[:, k]] for k in range(3))
    first, end = archive["collider_offsets"][item:item + 2]
    return (a * np.cross(b, c)).sum() / 6, places[first:end]


def mixed(program):
    open("seam.obj", "w").write(SEAM)
    json.dump(MIXED, open("mixed.json", "w"))
    hashes = run(program, "mixed.json", "-n", "3", "--hash", "-o", "m", "--states", "ms", *ALL)
    assert run(program, "mixed.json", "-n", "3", "--hash") == hashes, "the run is what it was"
    found = check_files("m", 1, 50)
    check_states(found, "ms")
    assert (found["body_offsets"] == [0, 20, 112, 119, 124]).all()
    assert (found["lines"][:, 0] == np.arange(112, 118)).all()
    assert np.isnan(found["uv"][24:204]).all() and (found["uv"][206] == [[.25, .5], [1, 0], [1, 1]]).all()
    assert (found["uv"][0] == [[0, 1], [0, np.float32(2 / 3)], [.25, 1]]).all()


def colliders(program):
    found = check_files("m", 1, 50)
    assert (found["colliders"] == [0, 1, 2, 3]).all()
    floor = found["collider_positions"][0][:4]
    assert (floor[:, 1] == -1).all() and (np.abs(floor[:, [0, 2]]) == 3).all()
    volume, ball = volume_of(found, 1)
    assert np.allclose(np.linalg.norm(ball - [0, -0.3, 0], axis=1), 0.15, rtol=1e-12)
    assert 0.97 < volume / (4 / 3 * np.pi * 0.15**3) < 1
    volume, capsule = volume_of(found, 3)
    start, way = np.array([-1.2, 0, 0]), np.array([0.4, 0, 0.1])
    share = np.clip((capsule - start) @ way / (way @ way), 0, 1)
    assert np.allclose(np.linalg.norm(capsule - start - share[:, None] * way, axis=1), 0.08)
    length = np.linalg.norm(way)
    assert 0.97 < volume / (np.pi * 0.08**2 * (length + 4 / 3 * 0.08)) < 1
    # of the box the flat faces are where they are to be, and it falls and turns
    r, half = 0.02, np.array([0.2, 0.1, 0.15])
    inner = 2 * half - 2 * r
    whole = (inner.prod() + 2 * r * (inner[0] * inner[1] + inner[1] * inner[2] + inner[2] * inner[0])
             + np.pi * r**2 * inner.sum() + 4 / 3 * np.pi * r**3)
    for k in range(len(found["times"])):
        volume, box = volume_of(found, 2, k)
        t = min(found["times"][k], 0.1)
        c, s = np.cos(20 * t), np.sin(20 * t)
        own = (box - [1, 0.2 - 5 * t, 0]) @ np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
        assert np.allclose(own.max(axis=0), half) and np.allclose(own.min(axis=0), -half)
        assert 0.995 < volume / whole < 1


def values(program):
    """The force at the start is m g where springs are at rest; strains are those of the grid."""
    found = np.load("m/run.npz")
    assert np.allclose(found["forces"][0][:20], [0, -9.81 * 0.01, 0], atol=1e-12)
    assert (found["strains"][0][:20] == 0).all() or abs(found["strains"][0][:20]).max() < 1e-12
    rest = 0.2
    for x, strains in zip(found["positions"], found["strains"]):
        sheet, most = x[:20].reshape(4, 5, 3), np.zeros((4, 5))
        for axis in 0, 1:
            d = np.linalg.norm(np.diff(sheet, axis=1 - axis), axis=2) / rest - 1
            for cut in (slice(None, -1), slice(1, None)):
                part = most[:, cut] if axis == 0 else most[cut]
                part[...] = np.where(abs(d) > abs(part), d, part)
        assert np.allclose(strains[:20], most.ravel(), atol=1e-12)


def every(program):
    run(program, "mixed.json", "-n", "5", "-o", "e", "--every", "2", "--states", "es", *ALL)
    check_states(check_files("e", 2, 50), "es", 2)
    for name, frame in ("thread", THREAD), ("alone", ALONE):
        json.dump(frame, open(name + ".json", "w"))
        run(program, name + ".json", "-n", "3", "-o", name, "--states", name + "-s", "--export",
            "obj,pc2,vtp,npz")
        check_states(check_files(name, 1, 60), name + "-s")


def sewn(program):
    """Stitches add up in their particles, pull with k d, and are gone once they are too long."""
    limit, k = 0.03, 100
    sheet = {"grid": [4, 3], "size": [0.3, 0.2]}
    scene = {
        "bodies": [{"cloth": sheet, "mass": {"total": 0.1}, "pins": ["top"]},
                   {"cloth": sheet | {"place": {"translate": [0, -0.2, 0]}}, "mass": {"total": 0.9}}],
        "seams": [{"body": 0, "particles": ["bottom"], "to": {"body": 1, "particles": ["top"]},
                   "stiffness": k, "breaking_length": limit},
                  {"body": 1, "particles": [0], "to": {"body": 0, "particles": [8, 9, 4], "weights": [0.5, 0.25, 0.25]},
                   "stiffness": 300}]}
    json.dump(scene, open("sewn.json", "w"))
    run(program, "sewn.json", "-n", "20", "-o", "w", "--states", "ws", *ALL)
    found = check_files("w", 1, 60)
    check_states(found, "ws")
    at, weights, x = found["stitches"], found["stitch_weights"], found["positions"]
    assert (at[:4] == [[8 + s, 12 + s, -1, -1] for s in range(4)]).all() and (at[4] == [12, 8, 9, 4]).all()
    assert (weights[:4] == [1, -1, 0, 0]).all() and (weights[4] == [1, -0.5, -0.25, -0.25]).all()
    lengths = np.linalg.norm(np.einsum("sk,fskc->fsc", weights, x[:, at]), axis=2)
    whole = found["stitch_counts"][:, 13:16] > 0
    counts = found["stitch_counts"]
    assert (counts[0] == np.bincount(at[at >= 0], minlength=24)).all() and counts[:, 4].min() == 1
    assert (lengths[:, 1:4][whole] <= limit).all() and (np.diff(whole.astype(int), axis=0) <= 0).all()
    assert not whole[-1].all() and lengths[-1, 1:4][~whole[-1]].max() > limit


def survey(folder):
    return {f: open(f"{folder}/{f}", "rb").read() for f in os.listdir(folder)
            if not f.endswith((".checkpoint", ".part")) and f != "manifest.txt"}


def resumed(program):
    run(program, "mixed.json", "-n", "2", "-o", "r", "--checkpoint", "2", "--every", "2", *ALL)
    # what a killed run wrote beyond its checkpoint does no harm
    for name in "bodies.pc2", "run.npz.part":
        open("r/" + name, "ab").write(b"half a sample")
    run(program, "mixed.json", "-n", "5", "--resume", "r", "--every", "2", *ALL)
    assert survey("r") == survey("e")
    os.remove("r/run.npz.part")
    run(program, "mixed.json", "-n", "6", "--resume", "r", "--every", "2", *ALL, code=4)


def broken_off(program):
    """On a full disk, as a limit of a file's size has it, all samples before are whole."""
    json.dump(ALONE, open("alone.json", "w"))
    limit = "ulimit -f 1; exec \"$@\""  # 512 bytes, or 1024
    done = subprocess.run(["sh", "-c", limit, "sh", program, "run", "alone.json", "-q", "-n", "40",
                           "--no-render", "-o", "f", "--export", "pc2"], capture_output=True, text=True)
    assert done.returncode == 4 and "f/bodies.pc2\": File too large" in done.stderr, done
    rate, cache = read_pc2("f/bodies.pc2")
    size = os.path.getsize("f/bodies.pc2")
    assert 4 <= len(cache) < 40 and size == 32 + cache.nbytes
    run(program, "alone.json", "-n", "40", "-o", "g", "--export", "pc2")
    assert (cache == read_pc2("g/bodies.pc2")[1][:len(cache)]).all()


def stopped(program):
    """Interrupted, a run leaves all of its samples; killed, all but the archive's."""
    for how, name in (signal.SIGINT, "i"), (signal.SIGKILL, "k"):
        run_ = subprocess.Popen([program, "run", "mixed.json", "-q", "-n", "100000", "--no-render",
                                 "-o", name, *ALL], stderr=subprocess.PIPE)
        while not os.path.exists(name + "/bodies_00003.obj"):
            time.sleep(0.001)
        run_.send_signal(how)
        run_.communicate()
        if how == signal.SIGINT:
            assert run_.returncode == 130 and len(check_files(name, 1, 50)["times"]) >= 4
            continue
        told = {file for time_, part, file in read_pvd(name + "/run.pvd")}
        there = {f for f in os.listdir(name) if f.endswith(".vtp")}
        assert len(told) >= 6 and told <= there and len(there - told) <= 2
        for file in told:
            read_vtp(f"{name}/{file}")
        for skin in "bodies", "colliders":
            assert abs(len(read_pc2(f"{name}/{skin}.pc2")[1]) - len(told) / 2) <= 1


def by_others(program):
    """meshio and VTK read every frame of three scenes, and find what NumPy does."""
    import meshio
    from vtk import vtkOBJReader, vtkXMLPolyDataReader
    from vtk.util.numpy_support import vtk_to_numpy

    def read(reader, path):
        reader.SetFileName(path)
        reader.Update()
        return reader.GetOutput()

    for scene in "hang", "winding", "bear_drape":
        run(program, f"scenes/{scene}.json", "-n", "10", "--every", "2", "-o", scene, *ALL)
        found = np.load(scene + "/run.npz")
        for skin, pre in ("bodies", ""), ("colliders", "collider_"):
            for k, places in enumerate(found[pre + "positions"] if pre + "positions" in found else []):
                path, faces = f"{scene}/{skin}_{k:05}", found[pre + "faces"]
                mesh = meshio.read(path + ".obj")
                assert np.allclose(mesh.points, places, rtol=1e-8, atol=0)
                assert (np.concatenate([c.data for c in mesh.cells]) == faces).all()
                obj = read(vtkOBJReader(), path + ".obj")
                assert np.allclose(vtk_to_numpy(obj.GetPoints().GetData()), places, rtol=1e-6)
                vtp = read(vtkXMLPolyDataReader(), path + ".vtp")
                assert (vtk_to_numpy(vtp.GetPoints().GetData()) == places).all()
                for data in obj, vtp:
                    cells = vtk_to_numpy(data.GetPolys().GetConnectivityArray())
                    assert (cells.reshape(-1, 3) == faces).all()
                uv = vtp.GetPointData().GetTCoords()
                assert pre or (vtk_to_numpy(uv)[faces] == found["uv"]).all()
                time = vtk_to_numpy(vtp.GetFieldData().GetArray("TimeValue"))[0]
                assert time == found["times"][k]
                for one, many in ("velocity", "velocities"), ("force", "forces"), ("strain", "strains"):
                    values = vtp.GetPointData().GetArray(one)
                    assert pre or (vtk_to_numpy(values) == found[many][k]).all()


def main():
    program, others = os.path.realpath(sys.argv[1]), sys.argv[2:] == ["vtk"]
    root, failed = os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__)))), 0
    tests = [mixed, colliders, values, every, sewn, resumed, broken_off, stopped]
    if others:
        try:
            import meshio, vtk  # noqa: F401
        except ImportError as missing:
            print(f"1..0 # SKIP {missing}: install python3-meshio and python3-vtk9")
            return 0
        tests = [by_others]
    print(f"1..{len(tests)}")
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        os.symlink(root + "/scenes", "scenes")
        for n, test in enumerate(tests, 1):
            try:
                test(program)
                print(f"ok {n} - {test.__name__}")
            except Exception as wrong:
                failed += 1
                line = wrong.__traceback__
                while line.tb_next:
                    line = line.tb_next
                print(f"not ok {n} - {test.__name__}\n# {type(wrong).__name__} in line "
                      f"{line.tb_lineno}: {wrong}")
    return failed > 0


if __name__ == "__main__":
    sys.exit(main())
