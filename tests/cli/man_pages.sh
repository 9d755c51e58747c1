#!/bin/sh
# man_pages.sh PROGRAM PAGE ... - every built page is whole: it has the headings of its source in
# their order, and text below the last one; clothsim-scene(5) names every key of the schema where
# it belongs (as TAP).
set -eu
export LC_ALL=C

program=$1
shift
root=$(cd "$(dirname "$0")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 1' INT TERM

n=0 failed=0
told() { # NAME: what is wrong lies in the file "wrong"
    n=$((n + 1))
    if [ -s "$work/wrong" ]; then
        failed=1
        echo "not ok $n - $1"
        sed 's/^/#   /' "$work/wrong"
    else
        echo "ok $n - $1"
    fi
}

for page; do
    name=$(basename "$page")
    # headings of the source without markup, as scdoc quotes those of several words
    sed -n '/^```$/,/^```$/!s/^##* //p' "$root/man/$name.scd" >"$work/source"
    sed -n 's/^\.S[HS] //p' "$page" | tr -d '"' >"$work/page"
    # headings that the program has made
    if [ "$name" = clothsim-scene.5 ] || [ "$name" = clothsim-files.5 ]; then
        tr -d '\\' <"$work/page" | grep -vF '[]' | grep -vxE '[a-z_]+(\.[a-z]+)*' >"$work/own" || true
        mv "$work/own" "$work/page"
    fi
    diff "$work/source" "$work/page" >"$work/wrong" || true
    awk '/^\.S[HS]/ { lines = 0; next } /^[^.]/ { lines++ }
        END { if (!lines) print "nothing below the last heading" }' "$page" >>"$work/wrong"
    told "$name has every section of its source"
done

for page; do
    [ "$(basename "$page")" = clothsim-scene.5 ] || continue
    # a key at the root is printed before the first heading of keys; \_ is an underscore of roff
    awk '/^\.SH / { place = "" }
        /^\.SS / { place = $2 "."; gsub(/\\_/, "_", place) }
        /^\\fB[a-z_]*\\fR: / {
            sub(/^\\fB/, ""); sub(/\\fR: .*/, ""); print place $0
        }' "$page" | sort -u >"$work/page"
    "$program" scene --schema | /usr/bin/python3 -c '
import json, sys

def walk(node, place, keys):
    for key, value in node.get("properties", {}).items():
        keys.add(place + key)
        walk(value, place + key + ".", keys)
    for choice in node.get("anyOf", []) + node.get("oneOf", []):
        walk(choice, place, keys)
    if isinstance(node.get("items"), dict):
        walk(node["items"], place[:-1] + "[].", keys)

schema, keys = json.load(sys.stdin), set()
walk(schema, "", keys)
# the options of integrators are in no list of keys: the page has a section instead
print("\n".join(keys - {key for key in keys if key.split(".")[0] == "integrator"}))' |
        sort -u >"$work/schema"
    : >"$work/wrong"
    [ "$(wc -l <"$work/schema")" -gt 100 ] || echo "the schema has few keys" >>"$work/wrong"
    comm -23 "$work/schema" "$work/page" | sed 's/^/not in the page: /' >>"$work/wrong"
    comm -13 "$work/schema" "$work/page" | sed 's/^/not in the schema: /' >>"$work/wrong"
    grep -q '^\.SH INTEGRATOR$' "$page" || echo "no section INTEGRATOR" >>"$work/wrong"
    told "clothsim-scene.5 names every key of the schema, and no other"
done
echo "1..$n"
exit $failed
