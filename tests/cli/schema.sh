#!/bin/sh
# The schema and the program agree: on every scene that ships, and on a handful of small scenes,
# good and bad. What only the program can see (a pin that does not exist) is not in the list.
program=$1
scenes=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$program" scene --schema >"$folder/schema.json" || exit 1
exec /usr/bin/python3 - "$program" "$scenes" "$folder" <<'PYTHON'
import glob, json, os, shutil, subprocess, sys
try:
    import jsonschema
except ImportError:
    print("python3-jsonschema is not installed")
    sys.exit(77)
program, scenes, folder = sys.argv[1:]
schema = json.load(open(folder + "/schema.json"))
jsonschema.Draft202012Validator.check_schema(schema)
validator = jsonschema.Draft202012Validator(schema)
cloth = '"cloth": {"grid": [3, 3]}'
body = cloth + ', "mass": {"total": 1}'
small = [
    '{"bodies": [{%s}]}' % body,
    '{"bodies": [{%s, "pins": ["top", 3, {"box": {"min": [0, 0, 0], "max": [1, 1, 1]}}]}]}' % body,
    '{"bodies": [{%s}], "integrator": "velocity-verlet", "x-note": 1}' % body,
    '{"bodies": [{%s}], "integrator": {"name": "velocity-verlet", "dt": 0.1}}' % body,
    '{"bodies": [{%s}], "colliders": [{"floor": {"height": -2}}]}' % body,
    '{"bodies": [{%s}], "events": [{"at": 1, "pin": {}}, {"from": 1, "to": 2, "wind": {"direction": [1, 0, 0]}}]}' % body,
    '{"bodies": [{%s}], "contact": "project", "colliders": [{"box": {"centre": [0, 0, -9], "size": [1, 1, 1]}}, {"capsule": {"from": [0, 0, -9], "to": [1, 0, -9]}}], "events": [{"at": 1, "move": {"collider": 1, "spin": [0, 1, 0]}}]}' % body,
    '{"bodies": [{%s}], "contact": {"law": "project", "damping": 0.1}}' % body,
    '{"bodies": [{%s}], "contact": {"law": "push"}}' % body,
    '{"bodies": [{%s}], "contact": 2}' % body,
    '{"bodies": [{%s}], "colliders": [{"box": {"centre": [0, 0, 0]}}]}' % body,
    '{}',
    '{"bodies": [{%s}], "bodys": []}' % body,
    '{"bodies": [{%s}]}' % cloth,
    '{"bodies": [{%s, "mass": {"total": 1, "particle": 1}}]}' % cloth,
    '{"bodies": [{%s, "mass": {"total": 0}}]}' % cloth,
    '{"bodies": [{%s, "mass": {"total": "1"}}]}' % cloth,
    '{"bodies": [{"cloth": {"grid": [3]}, "mass": {"total": 1}}]}',
    '{"bodies": [{"cloth": {"grid": [3, 2.5]}, "mass": {"total": 1}}]}',
    '{"bodies": [{%s, "pins": ["midle"]}]}' % body,
    '{"bodies": [{%s}], "colliders": [{}]}' % body,
    '{"bodies": [{%s}], "colliders": [{"floor": {}, "friction": -1}]}' % body,
    '{"bodies": [{%s}], "events": [{"at": 1}]}' % body,
    '{"bodies": [{%s}], "events": [{"at": 1, "pin": {}, "release": {}}]}' % body,
    '{"bodies": [{%s}], "events": [{"at": 1, "impact": {"impulse": 1}}]}' % body,
    '{"bodies": [{%s}], "forces": {"wind": {"velocity": [1, 0]}}}' % body,
    '{"bodies": [{%s}], "render": {"look": "pretty"}}' % body,
]
cases = [(os.path.basename(p), p) for p in sorted(glob.glob(scenes + "/*.json"))]
for number, text in enumerate(small):
    path = "%s/%d.json" % (folder, number)
    open(path, "w").write(text)
    cases.append((text, path))
failed = 0
for name, path in cases:
    by_schema = validator.is_valid(json.load(open(path)))
    by_program = subprocess.run([program, "scene", path], capture_output=True).returncode == 0
    if by_program != by_schema:
        failed += 1
        print("%s: program %s, schema %s" % (name, by_program, by_schema))
# each key that has a short form, in both forms: the schema takes them, and the program reads the
# same from the file and from --set
particles = [["\"top-left\"", "{\"at\": \"top-left\"}"], ["3", "{\"index\": 3}"]]
forms = {"contact": [["\"project\"", "{\"law\": \"project\"}"]],
         "pairs": [["\"all\"", "{\"among\": \"all\"}"]],
         "camera": [["\"auto\"", "{\"frame\": \"auto\"}"]],
         "render.background": [["\"none\"", "{\"kind\": \"none\"}"],
                               ["[0.1, 0.2, 0.3]", "{\"colour\": [0.1, 0.2, 0.3]}"]],
         "bodies[].elastic": [["\"denim\"", "{\"cloth\": \"denim\"}"]],
         "bodies[].elastic.bending": [["0.001", "{\"stiffness\": 0.001}"]],
         "integrator": [["\"rk4\"", "{\"name\": \"rk4\"}"]]}
forms |= {path: particles for path in (
    "bodies[].pins[]", "seams[].particles[]", "seams[].to.particles[]", "events[].impact.particles[]",
    "events[].grab.particles[]", "events[].pin.particles[]", "events[].release.particles[]",
    "render.marks.particles[]")}
forms |= {path: [["2", str([2] * n)]] for path, n in (
    ("bodies[].cloth.size", 2), ("bodies[].cloth.stretch", 2), ("bodies[].material.texture_repeat", 2),
    ("bodies[].mesh.scale", 3), ("colliders[].box.size", 3), ("colliders[].mesh.scale", 3))}
def short_keys(node, path):
    found = {path} if "anyOf" in node else set()
    for form in [node] + node.get("anyOf", []):
        for name, child in form.get("properties", {}).items():
            found |= short_keys(child, path + "." * bool(path) + name)
    return found | (short_keys(node["items"], path + "[]") if isinstance(node.get("items"), dict) else set())
unknown = short_keys(schema, "") ^ set(forms)
if unknown:
    failed += 1
    print("short forms of the schema and of this test differ: %s" % sorted(unknown))
def base(path):
    scene = {"bodies": [{"cloth": {"grid": [3, 3], "place": {"translate": [2.0 * k, 0, 0]}},
                         "mass": {"total": 1}, "pins": [8]} for k in range(2)], "render": {}}
    if "marks" in path:
        scene["render"] = {"marks": {"particles": [5]}}
    if "elastic" in path:
        scene["bodies"][0]["elastic"] = {"membrane": {"young": 100}}
    if "material" in path:
        scene["bodies"][0]["material"] = {"texture": "weave.png"}
        shutil.copy(scenes + "/weave.png", folder)
    if "mesh.scale" in path:
        scene["bodies"][0] = {"mesh": {"shape": "box"}, "mass": {"total": 1}}
    if path.startswith("colliders"):
        scene["contact"] = "force"
        scene["colliders"] = [{"box": {"centre": [0, -9, 0]}} if "box" in path else
                              {"mesh": {"shape": "box", "place": {"translate": [0, -9, 0]}}}]
    if path.startswith("seams"):
        scene["seams"] = [{"body": 0, "particles": [4], "to": {"body": 1, "particles": [4]}}]
    if path.startswith("events"):
        kind = path.split(".")[1]
        more = {"impact": {"direction": [1, 0, 0]}, "grab": {"path": [{"at": 1, "point": [0, 1, 0]}]}}
        scene["events"] = [{"at": 0.5, kind: {"body": 0, "particles": [4]} | more.get(kind, {})}]
    return scene
def place(scene, path, value):
    *way, last = path.replace("[]", ".0").split(".")
    for step in way:
        scene = scene[int(step)] if step == "0" else scene[step]
    scene[int(last) if last == "0" else last] = value
def resolved(scene, *options):
    path = folder + "/form.json"
    json.dump(scene, open(path, "w"))
    return subprocess.run([program, "scene", path, "--resolved", *options], capture_output=True, text=True).stdout
for path, pairs in forms.items():
    for pair in pairs:
        read = []
        for text in pair:
            scene = base(path)
            place(scene, path, json.loads(text))
            read += [resolved(scene), resolved(base(path), "--set", path.replace("[]", "[0]") + "=" + text)]
            if not validator.is_valid(scene):
                failed += 1
                print("%s = %s: the schema refuses it" % (path, text))
        if not read[0] or len(set(read)) != 1 or read[0] == resolved(base(path)):
            failed += 1
            print("%s: %s are not read alike" % (path, " and ".join(pair)))
good = sum(validator.is_valid(json.load(open(path))) for _, path in cases)
print("%d passed, %d failed" % (len(cases) - failed, failed))
sys.exit(1 if failed or good < 10 or good == len(cases) else 0)
PYTHON
