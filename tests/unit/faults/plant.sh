#!/bin/sh
# plant.sh SOURCE RESULT EXPRESSION - a copy of a source with a fault that sed plants in it.
set -eu
sed -e "$3" "$1" >"$2"
if cmp -s "$1" "$2"; then
    echo "plant.sh: $3 changes nothing in $1" >&2
    exit 1
fi
