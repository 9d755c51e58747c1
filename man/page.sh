#!/bin/sh
# page.sh SCDOC SOURCE [PROGRAM] - one man page to standard output; a line @KEYS@ of the source
# stands for the program's own list of scene keys. No page where the program or scdoc fails: a
# pipe tells only how its last command ended.
set -eu

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 1' INT TERM

sed '/^@KEYS@$/,$d' "$2" >"$work/source"
if [ $# -gt 2 ]; then
    "$3" scene --manual >>"$work/source"
    sed '1,/^@KEYS@$/d' "$2" >>"$work/source"
fi
"$1" <"$work/source" >"$work/page" || {
    echo "page.sh: scdoc fails on $2 (a line number above is that of the page with its keys)" >&2
    exit 1
}
awk '
    # scdoc puts a .P round every block: it means nothing at headings, and belongs behind .RE
    $0 == ".P" { waiting = !heading; next }
    $0 == ".RE" { print; next }
    { heading = /^\.S[HS]/ }
    waiting && !heading { print ".P" }
    { waiting = 0; print }' "$work/page"
