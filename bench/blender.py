#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""blender.py PROGRAM SCENE FRAMES [QUALITY/COLLISIONS ...] - a scene beside Blender's cloth.

PROGRAM (a clothsim) runs the scene first, with the scene's own method and one thread; then Blender
simulates the same sheets among the same obstacles, once for each pair of its settings "quality
steps" and "collision quality" (5/2, its defaults, if none is named). Both are seen alike: each
line gives processor seconds of the simulation, the most crossings of edges and triangles in a
frame, frames with any, and how far edges are stretched in the last frame, by the counter below,
which shares no code with either.

What is made equal: positions at rest and at the start, mass of a particle, stiffness of springs
along a cell and across it (Blender divides its own by the mean length of edges), gravity, drag, distance
of surfaces, frames a second. Particles that the scene holds or grabs, and obstacles, follow the
positions of clothsim's run. Friction: Blender's coefficient is 100 mu, 80 at most. What is not:
bending and damping are Blender's defaults; all bodies are one object, since two cloth
objects only push one way, and so have one mass a particle; soft bodies have its internal springs.

Needs numpy and blender (3.4; Debian: apt-get install blender).
"""
import json
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

CHUNK = 128  # triangles whose boxes are compared with those of all edges at a time


def edges_of(faces):
    return np.unique(np.sort(np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])), axis=0) \
        if len(faces) else np.zeros((0, 2), int)


def crossings(points, edges, faces):
    """Pairs of an edge and a triangle without a common vertex that meet in an inner point."""
    a, b = points[edges[:, 0]], points[edges[:, 1]]
    edge_low, edge_high = np.minimum(a, b), np.maximum(a, b)
    corners = points[faces]
    low, high = corners.min(1), corners.max(1)
    n = 0
    for first in range(0, len(faces), CHUNK):
        part = slice(first, first + CHUNK)
        near = np.all((low[part, None] <= edge_high) & (edge_low <= high[part, None]), axis=2)
        t, e = np.nonzero(near)
        t += first
        apart = ~np.any(faces[t][:, :, None] == edges[e][:, None, :], axis=(1, 2))
        t, e = t[apart], e[apart]
        # both ends on either side of the plane, and the line on one side of all three edges
        p, q, r = corners[t, 0], corners[t, 1], corners[t, 2]

        def volume(u, v, w, x):
            return np.einsum("ij,ij->i", np.cross(v - u, w - u), x - u)
        parted = volume(p, q, r, a[e]) * volume(p, q, r, b[e]) < 0
        sides = np.stack([volume(a[e], b[e], p, q), volume(a[e], b[e], q, r), volume(a[e], b[e], r, p)])
        n += np.count_nonzero(parted & (np.all(sides > 0, axis=0) | np.all(sides < 0, axis=0)))
    return n


class Case:
    """What a clothsim run leaves: rest, obstacles, held particles and frames."""

    def __init__(self, scene_path, folder):
        self.scene = json.loads(Path(scene_path).read_text())
        run = np.load(folder / "run.npz")
        self.faces, self.positions = run["faces"].astype(int), run["positions"]
        self.colliders = np.zeros((0, 3), int)
        self.collider_positions = np.zeros((1, 0, 3))
        if "collider_faces" in run:
            self.colliders, self.collider_positions = run["collider_faces"].astype(int), run["collider_positions"]
        if len(self.collider_positions) == 1:  # none moves
            self.collider_positions = np.repeat(self.collider_positions, len(self.positions), axis=0)
        self.offsets, self.face_offsets = run["body_offsets"], run["face_offsets"]
        self.fps = self.scene.get("time", {}).get("fps", 60)
        self.edges = edges_of(self.faces)

    def held(self):
        """Particles that pins and grabs hold, of all bodies."""
        held = set()
        for k, body in enumerate(self.scene["bodies"]):
            for pin in body.get("pins", []):
                held |= self.named(k, pin["particles"] if isinstance(pin, dict) else [pin])
        for event in self.scene.get("events", []):
            if "grab" in event:
                held |= self.named(event["grab"].get("body", 0), event["grab"]["particles"])
        return sorted(held)

    def named(self, k, particles):
        first, grid = int(self.offsets[k]), self.scene["bodies"][k].get("cloth", {}).get("grid")
        found = set()
        for p in particles:
            if isinstance(p, int):
                found.add(first + p)
            elif p in ("left", "right"):
                column = 0 if p == "left" else grid[0] - 1
                found |= {first + row * grid[0] + column for row in range(grid[1])}
            else:
                sys.exit(f"blender.py: particles {p!r} are not known here")
        return found

    def soft(self):
        """Particles of bodies with springs through their inside."""
        return [i for k, body in enumerate(self.scene["bodies"]) if "network" in body
                for i in range(int(self.offsets[k]), int(self.offsets[k + 1]))]

    def polygons(self):
        """Faces as Blender gets them: squares of grids, triangles of meshes."""
        out = []
        for k, body in enumerate(self.scene["bodies"]):
            if "cloth" in body:
                w, h = body["cloth"]["grid"]
                at = int(self.offsets[k]) + np.arange(w * h).reshape(h, w)
                out += np.stack([at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]], -1).reshape(-1, 4).tolist()
            else:
                out += self.faces[self.face_offsets[k]:self.face_offsets[k + 1]].tolist()
        return out

    def row(self, name, positions, seconds):
        own, other = self.faces, self.colliders + positions.shape[1]
        counts = []
        for k, x in enumerate(positions):
            points = np.vstack([x, self.collider_positions[k]])
            if not np.all(np.isfinite(points)):
                counts.append(-1)
                continue
            counts.append(crossings(points, self.edges, np.vstack([own, other])) +
                          crossings(points, edges_of(other), own))
        length = [np.linalg.norm(x[self.edges[:, 0]] - x[self.edges[:, 1]], axis=1) for x in positions[[0, -1]]]
        strain = 100 * (length[1] / length[0] - 1)
        print(f"{name:24} {seconds:8.1f} s  crossings {max(counts):6}, in {np.count_nonzero(counts):4} of "
              f"{len(counts) - 1} frames  stretch rms {np.sqrt(np.mean(strain ** 2)):6.2f} %, "
              f"largest {strain.max():7.2f} %", flush=True)


def seconds_of(command):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def write_pc2(path, positions):
    with open(path, "wb") as out:
        out.write(b"POINTCACHE2\0" + np.array([1, positions.shape[1]], "<i4").tobytes() +
                  np.array([0, 1], "<f4").tobytes() + np.array([len(positions)], "<i4").tobytes() +
                  positions.astype("<f4").tobytes())


def main(program, scene, frames, *settings):
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        seconds = seconds_of([program, "run", scene, "-n", frames, "--no-render", "--export", "npz",
                              "-o", name, "-y", "-q", ])
        case = Case(scene, folder)
        case.row("clothsim", case.positions, seconds)
        write_pc2(folder / "bodies.pc2", case.positions)
        write_pc2(folder / "colliders.pc2", case.collider_positions)
        first = case.scene["bodies"][0]
        cell = np.linalg.norm(case.positions[0][case.edges[:, 0]] - case.positions[0][case.edges[:, 1]], axis=1).mean()
        start = case.positions[0]
        (folder / "case.json").write_text(json.dumps({
            "folder": name, "fps": case.fps, "frames": int(frames), "held": case.held(), "soft": case.soft(),
            "polygons": case.polygons(), "start": start.tolist(),
            "colliders": case.colliders.tolist(), "collider_start": case.collider_positions[0].tolist(),
            "cell": cell, "mass": masses(case), "springs": first["springs"],
            "gravity": case.scene.get("forces", {}).get("gravity", [0, -9.81, 0]),
            "thickness": first.get("thickness", cell / 2),
            "range": max([c.get("thickness", 0) for c in case.scene.get("colliders", [])] + [0]) or cell / 2,
            "drag": case.scene.get("forces", {}).get("drag", 0),
            "friction": max([c.get("friction", 0) for c in case.scene.get("colliders", [])] + [0]),
            "self_friction": first.get("friction", 0)}))
        for setting in settings or ("5/2",):
            os.environ["BLENDER_CASE"] = f"{name}/case.json {setting}"
            subprocess.run(["blender", "-b", "--factory-startup", "-t", "1", "-P", __file__],
                           check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            out = np.load(folder / "blender.npz")
            case.row(f"blender {setting}", out["positions"], float(out["seconds"]))


def masses(case):
    """Mass of a particle in kg: the mean of the first body."""
    body = case.scene["bodies"][0]
    n = int(case.offsets[1])
    if "total" in body["mass"]:
        return body["mass"]["total"] / n
    p = case.positions[0][case.faces[:case.face_offsets[1]]]
    area = np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1).sum() / 2
    return body["mass"]["areal_density"] * area / n


def inside_blender():
    import time

    import bpy
    path, setting = os.environ["BLENDER_CASE"].split()
    case = json.loads(Path(path).read_text())
    quality, collisions = (int(word) for word in setting.split("/"))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.gravity, scene.render.fps = case["gravity"], round(case["fps"])
    scene.frame_start, scene.frame_end = 1, case["frames"] + 1

    def add(name, points, faces):
        mesh = bpy.data.meshes.new(name)
        mesh.from_pydata(points, [], faces)
        ob = bpy.data.objects.new(name, mesh)
        scene.collection.objects.link(ob)
        cache = ob.modifiers.new("follows", "MESH_CACHE")
        cache.cache_format, cache.filepath, cache.frame_start = "PC2", f"{case['folder']}/{name}.pc2", 1
        return ob

    if case["colliders"]:
        ob = add("colliders", case["collider_start"], case["colliders"])
        ob.modifiers.new("collision", "COLLISION")
        ob.collision.thickness_outer = ob.collision.thickness_inner = max(0.001, case["range"] / 2)
        ob.collision.damping = 0
        ob.collision.cloth_friction = min(80, 100 * case["friction"])
    ob = add("bodies", case["start"], case["polygons"])
    cloth = ob.modifiers.new("cloth", "CLOTH")
    own, touch = cloth.settings, cloth.collision_settings
    own.quality, own.mass = quality, case["mass"]
    springs = case["springs"]
    own.tension_stiffness = own.compression_stiffness = springs["stretch"] * case["cell"]
    own.shear_stiffness = springs.get("shear", springs["stretch"]) * case["cell"]
    own.air_damping = case["drag"] / 0.01  # N s/m of a particle; Blender's 1 is 0.01
    if case["held"]:
        group = ob.vertex_groups.new(name="held")
        group.add(case["held"], 1, "REPLACE")
        own.vertex_group_mass = "held"
    else:  # without held particles the cloth has no goal to follow
        ob.modifiers.remove(ob.modifiers["follows"])
    if case["soft"]:
        ob.vertex_groups.new(name="soft").add(case["soft"], 1, "REPLACE")
        own.use_internal_springs, own.vertex_group_intern = True, "soft"
    touch.use_collision, touch.collision_quality = True, collisions
    touch.distance_min, touch.friction = max(0.001, case["range"] / 2), min(80, 100 * case["friction"])
    touch.use_self_collision, touch.self_distance_min = True, max(0.001, case["thickness"] / 2)
    touch.self_friction = min(80, 100 * case["self_friction"])
    cloth.point_cache.frame_start, cloth.point_cache.frame_end = 1, case["frames"] + 1
    positions, spent = [], 0.0
    for frame in range(1, case["frames"] + 2):
        before = time.process_time()
        scene.frame_set(frame)
        spent += time.process_time() - before
        mesh = ob.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
        flat = np.empty(3 * len(mesh.vertices))
        mesh.vertices.foreach_get("co", flat)
        positions.append(flat.reshape(-1, 3))
    np.savez(f"{case['folder']}/blender.npz", positions=np.array(positions), seconds=spent)


if "BLENDER_CASE" in os.environ:
    inside_blender()
elif len(sys.argv) < 4:
    sys.exit(__doc__)
else:
    main(*sys.argv[1:])
