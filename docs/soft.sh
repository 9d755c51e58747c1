#!/bin/sh
# soft.sh [PROGRAM] - makes the figure and the tables of soft.md anew, into docs/soft/, in seconds.
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
gnuplot pulsation.gp
