#!/bin/sh
# hooke.sh - fig. 5.3 of the cloth thesis: the force of two springs over their length, of two scenes in one
# diagram. Prints the last row. Run where docs is.
set -eu

for scene in spring soft_spring; do
    clothsim plot "docs/sources/$scene.json" --stretch 0.5..1.5 --format svg -o "$scene" -q
    tail -n +2 "$scene.csv" | cut -d, -f2 >"$scene.force"
done
{
    echo "length_over_start,75_per_m,25_per_m"
    tail -n +2 spring.csv | cut -d, -f1 | paste -d, - spring.force soft_spring.force
} >hooke.csv
clothsim plot hooke.csv --x length_over_start --title "Force in N of springs of 75 and 25 N/m over their length" -o hooke
tail -n 1 hooke.csv
