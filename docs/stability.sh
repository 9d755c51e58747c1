#!/bin/sh
# stability.sh [PROGRAM] - makes every figure and table of stability.md anew, into docs/stability/,
# in a few minutes.
set -eu

program=$(realpath "${1:-build/clothsim}")
cd "$(dirname "$0")/.."
out=docs/stability
grid='bodies[0].cloth.grid'
mkdir -p $out

# the default map, then smaller ones of the methods that have no limit in linear theory
"$program" stability scenes/hang.json -i symplectic-euler -o $out -y >$out/maps.txt
for method in implicit-linearised implicit-block; do
    "$program" stability scenes/hang.json -i $method --set "$grid=[16, 16]" --columns 7 --rows 11 \
        --dt 1e-4..3e-2 -o $out -y
done >>$out/maps.txt
"$program" stability scenes/drum.json -i explicit-euler --axis damping --set "$grid=[16, 16]" \
    --dt 1e-5..1e-2 -o $out -y >>$out/maps.txt

for method in explicit-euler:dt=0.016666666666666666 explicit-euler:dt=0.0016666666666666668 \
    implicit-linearised:dt=0.016666666666666666 implicit-block:dt=0.016666666666666666 \
    velocity-verlet:dt=0.0016666666666666668; do
    echo "$method"
    "$program" run scenes/explosion.json -n 1200 --no-render -i $method \
        --monitor "$out/$(echo $method | tr ':=' '__' | cut -c 1-30).csv" -y 2>/dev/null |
        sed -n '/^outcome/,/^energy/p' | grep -vE '^(steps|evaluations|iterations)' || true
done >$out/story.txt

"$program" advise scenes/hang.json --set "$grid=[16, 16]" --check --quiet >$out/advise.txt
"$program" stability --extreme >$out/extreme.txt
