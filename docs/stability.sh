#!/bin/sh
# stability.sh [PROGRAM] - makes every figure and table of stability.md anew, into docs/stability/.
set -eu

program=$(realpath "${1:-build/clothsim}")
cd "$(dirname "$0")/.."
out=docs/stability
mkdir -p $out

for method in symplectic-euler implicit-linearised implicit-block; do
    "$program" stability scenes/hang.json -i $method -o $out -y
done >$out/maps.txt
"$program" stability scenes/drum.json -i explicit-euler --axis damping -t 0.5 --dt 1e-6..1e-2 \
    -o $out -y >>$out/maps.txt

for method in explicit-euler:dt=0.016666666666666666 explicit-euler:dt=0.0016666666666666668 \
    implicit-linearised:dt=0.016666666666666666 implicit-block:dt=0.016666666666666666 \
    velocity-verlet:dt=0.0016666666666666668; do
    echo "$method"
    "$program" run scenes/explosion.json -n 1200 --no-render -i $method \
        --watch "$out/$(echo $method | tr ':=' '__' | cut -c 1-30).csv" -y 2>/dev/null |
        grep -A1 -E '^(outcome|watch|energy)' | grep -vE '^(steps|evaluations|largest|--)' || true
done >$out/story.txt

"$program" advise scenes/hang.json --check >$out/advise.txt
"$program" stability --extreme >$out/extreme.txt
