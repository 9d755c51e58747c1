#!/bin/sh
# soft.sh [PROGRAM] - makes the figure and the tables of soft.md anew, into docs/soft/,
# in a few minutes.
set -eu

program=$(realpath "${1:-build/clothsim}")
cd "$(dirname "$0")/soft"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 1' INT TERM

# frame, time and farthest coordinate over that at the start, of a ball at rest: rotation, kg, file
size() {
    "$program" run rest.json -n 180 --no-render --states "$work/$3" --set integrator.rotation="$1" \
        --set "bodies[0].mass.total=$2" >/dev/null
    for file in "$work/$3"/x_*.npy; do
        od -A n -t f8 -j 128 -v "$file" | awk -v frame="$(basename "$file" .npy | tr -d 'x_')" '
            { for (k = 1; k <= NF; k++) { a = $k < 0 ? -$k : $k; if (a > most) most = a } }
            END { printf "%d %.15g\n", frame, most }'
    done | awk 'NR == 1 { start = $2 } { printf "%d,%.6f,%.15g\n", $1, $1 / 60, $2 / start }' >"$3.csv"
}
size polar 1 polar
size unrooted-linear 1 unrooted-linear
size unrooted-pq 1 unrooted-pq
size unrooted-pq 362 unrooted-pq-heavy

# what becomes of a fall, by alpha and rotation
for alpha in 0.1 0.5 0.9 1; do
    for rotation in polar unrooted-linear unrooted-pq; do
        printf '%-5s %-16s ' $alpha $rotation
        "$program" run drop.json -n 300 --no-render --set integrator.rotation=$rotation \
            --set "bodies[0].shape_matching.alpha=$alpha" 2>&1 | sed -n 's/^outcome  *//p' |
            sed 's/, particle.*//'
    done
done >drop.txt
{
    echo "t,A_pq without the root (1 kg),A_pq without the root (362 kg),A without the root,with the root"
    paste -d, unrooted-pq.csv unrooted-pq-heavy.csv unrooted-linear.csv polar.csv |
        awk -F, -v OFS=, 'function in_view(x) { return x > 0.02 && x < 20 ? x : "" }
            { print $2, in_view($3), in_view($6), in_view($9), in_view($12) }'
} >pulsation.csv
"$program" plot pulsation.csv --log y --format png --title "size of a ball at rest over that at the start" -q
for over in springs vertices; do
    "$program" plot soft.csv --x $over --y one_step_per_s,frames_per_s --log xy --format png -o soft_$over \
        --title "soft bodies, simulated only: pictures per second over $over" -q
done

# the same body of springs and drawn back to its shape: at rest, thrown, hung by a vertex of an ear
picture() { # NAME FRAME SETTING ...
    name=$1 frame=$2
    shift 2
    for kind in springs matched; do
        "$program" run $kind.json -n "$frame" -o "$work/$name-$kind" --quiet "$@"
        cp "$work/$name-$kind/frame_$(printf %05d "$frame").png" "$name-$kind.png"
    done
}
place='bodies[0].mesh.place.translate'
picture rest 240
picture thrown 30 --set "$place=[-0.8, 0.7, 0]" --set 'bodies[0].mesh.velocity=[1.2, 2.2, 0]' \
    --set 'bodies[0].mesh.spin=[0, 0, -6]'
picture hung 60 --set "$place=[0, 0.72, 0]" --set 'bodies[0].pins=[612]'

# what both cost, without the pictures: a second of this renderer says more of it than of them
"$program" soft-bench ../../scenes/bear_springs.json --no-render -o . -y >/dev/null
