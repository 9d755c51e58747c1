# SPDX-License-Identifier: MIT
"""Opens what `clothsim run --export obj,pc2` wrote in Blender and saves it as a file of Blender's.

usage: blender --background --python examples/blender.py -- DIR [OUT.blend]

Each of bodies_00000.obj and colliders_00000.obj in DIR becomes an object, played by the modifier
Mesh Cache where a .pc2 of its name lies beside it. Blender's frame k is sample k of the run. Every
frame is held to the OBJ file of its number, and the largest distance is printed.
"""
import glob
import os
import struct
import sys

import bpy


def read_places(path):
    return [[float(w) for w in line.split()[1:]] for line in open(path) if line.startswith("v ")]


def load(folder, name):
    """The object, and how many samples it has."""
    path = os.path.join(folder, name)
    bpy.ops.wm.obj_import(filepath=path + "_00000.obj")
    made = bpy.context.selected_objects[0]
    made.name = name
    made.data.polygons.foreach_set("use_smooth", [name == "bodies"] * len(made.data.polygons))
    if not os.path.exists(path + ".pc2"):
        return made, 1
    cache = made.modifiers.new("run", "MESH_CACHE")
    cache.cache_format, cache.filepath, cache.frame_start = "PC2", os.path.abspath(path + ".pc2"), 0
    with open(path + ".pc2", "rb") as file:
        return made, struct.unpack("<12siiffi", file.read(32))[5]


def distance(made, folder, name, sample):
    """Largest distance in m of the object's points from those of an OBJ file."""
    places = read_places(os.path.join(folder, f"{name}_{sample:05}.obj"))
    shown = made.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.vertices
    assert len(shown) == len(places), f"{name}: {len(shown)} points, expected {len(places)}"
    return max((sum((a - b)**2 for a, b in zip(v.co, p))**0.5 for v, p in zip(shown, places)))


def main():
    folder, *out = sys.argv[sys.argv.index("--") + 1:]
    bpy.ops.wm.read_homefile(use_empty=True)
    names = [n for n in ("bodies", "colliders") if glob.glob(f"{folder}/{n}_00000.obj")]
    loaded = {name: load(folder, name) for name in names}
    last = max(samples for made, samples in loaded.values()) - 1
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 0, last
    for name, (made, samples) in loaded.items():
        worst = 0
        for sample in range(samples):
            bpy.context.scene.frame_set(sample)
            worst = max(worst, distance(made, folder, name, sample))
        mesh = made.data
        print(f"{name}: {len(mesh.vertices)} points, {len(mesh.polygons)} faces, "
              f"{'with' if mesh.uv_layers else 'without'} UV, {samples} samples, "
              f"at most {worst:.2g} m from the OBJ files")
    if out:
        bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath(out[0]))


main()
