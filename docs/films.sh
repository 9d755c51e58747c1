#!/bin/sh
# films.sh [PROGRAM] - makes docs/films anew: the scenes of contact.md that stand beside Blender's cloth, and
# the walking bear; a quarter of an hour. Needs ffmpeg.
set -eu

program=$(realpath "${1:-build/clothsim}")
cd "$(dirname "$0")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 1' INT TERM

for film in needles:125 reef_knot:120 twister:156 funnel:180 hard/pull:60 winding:150 walking_bear:240; do
    scene=${film%:*}
    name=${scene##*/}
    "$program" run "scenes/$scene.json" -n "${film#*:}" -s 'render.size=[400,300]' -o "$work/$name" -q
    "$program" film "$work/$name" -o "docs/films/$name.mp4" -y -q
done
