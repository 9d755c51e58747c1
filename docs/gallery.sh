#!/bin/sh
# gallery.sh [FILM ...] - makes the films of docs/films and their contact sheets anew, or those
# named; about ten minutes for the fourteen of the README. PROGRAM: which clothsim. Needs ffmpeg.
set -eu

program=$(realpath "${PROGRAM:-$(dirname "$0")/../build/clothsim}")
cd "$(dirname "$0")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 1' INT TERM

# run NAME SCENE [OPTION ...]: pictures of a scene into a folder of that name
run() {
    name=$1 scene=$2
    shift 2
    echo "  clothsim run scenes/$scene.json $*"
    "$program" run "scenes/$scene.json" -s 'render.size=[400,300]' -o "$work/$name" -q "$@" 2>"$work/log" || {
        cat "$work/log" >&2
        exit 1
    }
}

# film NAME RUN [OPTION ...]: one run as a film, and six of its pictures
film() {
    name=$1 from=$2
    shift 2
    "$program" film "$work/$from" -o "docs/films/$name" -y -q "$@"
    "$program" film "$work/$from" --sheet 6x1 --tile 150 -o "docs/films/${name%.*}.png" -y -q
}

# side NAME RUN ...: several runs side by side with method, cost and error
side() {
    name=$1
    shift
    (cd "$work" && "$program" film "$@" --titles --tile 300 -o "film.webm" -y -q)
    mv "$work/film.webm" "docs/films/$name"
    stills "docs/films/$name"
}

# stills FILM: four of its pictures below each other
stills() {
    frames=$(ffprobe -loglevel error -count_frames -show_entries stream=nb_read_frames -of csv=p=0 "$1")
    ffmpeg -loglevel error -y -i "$1" -vf "select='not(mod(n\\,$((frames / 3 > 1 ? frames / 3 : 1))))',scale=iw*3/4:-1,tile=1x3" \
        -frames:v 1 "${1%.*}.png"
}

# a stability map as its cells come in, from the table of docs/stability.sh
map() {
    table=docs/stability/symplectic-euler.csv
    mkdir -p "$work/map"
    cells=$(($(wc -l <$table) - 1)) picture=0
    cp "${table%.csv}_border.csv" "$work/map/part_border.csv"
    for n in $(seq 3 3 "$cells") "$cells" "$cells" "$cells" "$cells" "$cells"; do
        picture=$((picture + 1))
        # cells that did not come in yet have no verdict: a place, and no colour
        awk -F, -v OFS=, -v n="$n" 'NR > n + 1 { $3 = $4 = "" } 1' $table >"$work/map/part.csv"
        "$program" plot "$work/map/part.csv" --title "symplectic-euler: stable time steps, hang.json" \
            --width 130 --format png -o "$work/map/$(printf %03d $picture)" -q
    done
    ffmpeg -loglevel error -y -framerate 8 -i "$work/map/%03d.png" -vf scale=800:-2 -pix_fmt yuv420p -c:v libvpx-vp9 -crf 30 -b:v 0 \
        docs/films/map.webm
    stills docs/films/map.webm
}

make() {
    case $1 in
        tablecloth) run $1 table_cloth -n 120 -s 'bodies[0].cloth.grid=[48,48]' && film $1.webm $1 ;;
        flag) run $1 flag_wind -n 240 -s 'bodies[0].cloth.grid=[36,24]' && film $1.webm $1 ;;
        knot) run $1 reef_knot -n 120 && film $1.webm $1 ;;
        funnel) run $1 funnel -n 180 -s 'bodies[0].cloth.grid=[13,13]' -s 'bodies[1].cloth.grid=[13,13]' \
            -s 'bodies[2].cloth.grid=[13,13]' && film $1.webm $1 ;;
        twister) run $1 twister -n 156 && film $1.webm $1
            "$program" run scenes/twister.json -n 120 -s 'render.size=[360,216]' -o "$work/gif" -q
            "$program" film "$work/gif" -o docs/films/twister.gif -y -q ;;
        bag) run $1 bag -n 90 && film $1.webm $1 ;;
        hammock) run $1 hard/hammock -n 90 -s 'bodies[0].cloth.grid=[20,20]' && film $1.webm $1 ;;
        curtain) run $1 curtain_rail -n 240 --every 2 && film $1.webm $1 ;;
        skirt | sail | tent | parachute | balloon | clothes_line) run $1 $1 -n 240 && film $1.webm $1 ;;
        bears) run $1 bear_heap -n 90 && film $1.webm $1 ;;
        instability)
            run local explosion -n 226 --every 2 --mark-instability -s 'render.look=wireframe'
            run global explosion -n 226 --every 2 --mark-instability -s 'render.look=wireframe' \
                -i velocity-verlet:dt=0.016666666666666666 -s 'bodies[0].springs.stretch=2500'
            side $1.webm local global
            ;;
        methods)
            for method in gauss:order=6,dt=0.002 backward-euler:dt=0.016666666666666666 \
                bdf2:dt=0.016666666666666666 tr-bdf2:dt=0.016666666666666666; do
                run "${method%%:*}" swing -n 90 -i $method --states "$work/${method%%:*}"
            done
            side $1.webm gauss backward-euler bdf2 tr-bdf2
            ;;
        map) map ;;
        # beside Blender's cloth, and the walking bear: docs/results/contact-blender.md
        needles) run $1 needles -n 125 && film $1.mp4 $1 ;;
        pull) run $1 hard/pull -n 60 && film $1.mp4 $1 ;;
        winding) run $1 winding -n 150 && film $1.mp4 $1 ;;
        walking_bear) run $1 walking_bear -n 240 && film $1.mp4 $1 ;;
        *) echo "gallery: no film \"$1\"" >&2 && exit 2 ;;
    esac
}

[ $# -gt 0 ] || set -- tablecloth flag knot funnel twister bag curtain skirt parachute balloon bears instability methods map
for film; do
    echo "$film"
    make "$film"
done
