#!/bin/sh
# The schema and the program agree: on every scene that ships, and on a handful of small scenes,
# good and bad. What only the program can see (a pin that does not exist) is not in the list.
program=$1
scenes=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$program" scene --schema >"$folder/schema.json" || exit 1
exec /usr/bin/python3 - "$program" "$scenes" "$folder" <<'PYTHON'
import glob, json, os, subprocess, sys
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
    '{"bodies": [{%s}], "forces": {"wind": {"strength": 1}}}' % body,
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
good = sum(validator.is_valid(json.load(open(path))) for _, path in cases)
print("%d passed, %d failed" % (len(cases) - failed, failed))
sys.exit(1 if failed or good < 10 or good == len(cases) else 0)
PYTHON
