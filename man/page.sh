#!/bin/sh
# page.sh SCDOC SOURCE [PROGRAM] - one man page to standard output; a line @KEYS@ of the source
# stands for the program's own list of scene keys
set -eu

{
    sed '/^@KEYS@$/,$d' "$2"
    if [ $# -gt 2 ]; then
        "$3" scene --manual
        sed '1,/^@KEYS@$/d' "$2"
    fi
} | "$1" | awk '
    # scdoc puts a .P round every block: it means nothing at headings, and belongs behind .RE
    $0 == ".P" { waiting = !heading; next }
    $0 == ".RE" { print; next }
    { heading = /^\.S[HS]/ }
    waiting && !heading { print ".P" }
    { waiting = 0; print }'
