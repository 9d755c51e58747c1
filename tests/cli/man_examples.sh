#!/bin/sh
# man_examples.sh PROGRAM [slow] - runs every line of every EXAMPLES section of the man pages (as
# TAP); those of a block below the remark "; slow" only where that is asked for, and then no others.
#
# A block of a page that opens with `{` is the scene sketch.json, one that opens with a comment
# `/* NAME.c` is that file; both are there when the page's examples run, each page in an own folder.
set -eu

program=$(realpath "$1")
speed=${2:-quick}
root=$(cd "$(dirname "$0")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 1' INT TERM

mkdir "$work/bin"
ln -s "$program" "$work/bin/clothsim"
PATH=$work/bin:$PATH
CPATH=$root/include
export PATH CPATH LC_ALL=C

n=0 failed=0
for page in "$root"/man/*.scd; do
    folder=$work/$(basename "$page" .scd)
    mkdir "$folder"
    ln -s "$root/scenes" "$root/golden" "$folder"
    awk -v folder="$folder" -v speed="$speed" '
        /^# / { examples = $0 == "# EXAMPLES" }
        /^; slow$/ { slow = 1; next }
        /^```$/ {
            inside = !inside; into = ""; first = inside
            wanted = examples && (slow ? "slow" : "quick") == speed
            if (!inside) slow = 0
            next
        }
        !inside { next }
        first && /^{/ { into = folder "/sketch.json" }
        first && /^\/\* [a-z]*\.c / { into = folder "/" $2 }
        { first = 0 }
        into { print > into; next }
        wanted && sub(/ \\$/, "") { printf "%s", $0 > (folder "/examples"); next }
        wanted { print > (folder "/examples") }' "$page"
    if ! [ -s "$folder/examples" ]; then
        [ "$speed" = quick ] || continue
        n=$((n + 1)) failed=1
        echo "not ok $n - $(basename "$page") has no examples"
        continue
    fi
    while read -r line; do
        n=$((n + 1))
        verdict=ok
        (cd "$folder" && sh -c "$line") >"$work/output" 2>&1 </dev/null || verdict="not ok" failed=1
        echo "$verdict $n - $(basename "$page"): $(echo "$line" | cut -c 1-60)"
        [ "$verdict" = ok ] || sed 's/^/#   /' "$work/output"
    done <"$folder/examples"
done
[ $n -gt 0 ] || failed=1
echo "1..$n"
exit $failed
