#!/bin/sh
# kinds.sh ROOT CC [ARG ...] - a kind that is added by half does not compile (as TAP): a collider shape,
# a look and an export format of which a copy of the sources has the line in the list alone, or a
# bound of shapes that no switch knows. The copy as it is compiles.
set -u
root=$1
shift
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp -R "$root/src" "$root/include" "$work" || exit 1
cd "$work" || exit 1
n=0 failed=0

# expect refused|taken WHAT FILE ...: what the compiler does with the files of the copy
expect() {
    wanted=$1 what=$2 found=taken
    shift 2
    for file; do
        $cc "src/$file" 2>> said || found=refused
    done
    n=$((n + 1))
    if [ $found = "$wanted" ]; then
        echo "ok $n - $what is $found"
    else
        echo "not ok $n - $what is $found, expected $wanted"
        sed 's/^/# /' said
        failed=1
    fi
    : > said
}

# plant WHAT HEADER EXPRESSION FILE ...: a header of the copy with one line more
plant() {
    what=$1 header=src/$2 line=$3
    shift 3
    cp "$header" whole
    sed "$line" whole > "$header"
    if cmp -s whole "$header"; then
        echo "# $header has no place for $what"
        failed=1
    fi
    expect refused "$what" "$@"
    cp whole "$header"
}

cc="$* -std=c17 -D_GNU_SOURCE -Iinclude -Isrc -fsyntax-only -Wall -Wextra -Wswitch-enum -Werror"
shapes='scene/collider_keys.c model/contact/posed_collider.c'
expect taken 'what is whole' $shapes draw/look.c export/export.c
plant 'half a collider shape' scene/collider_keys.h 's/^    X(sphere, .*$/& X(torus, cs_torus, "a torus") \\/; s/\\ X(torus/X(torus/' $shapes
plant 'half a look' scene/picture_keys.h 's/^    X(LIT, lit)/& X(DEPTH, depth)/' draw/look.c
plant 'half an export format' export/writer.h 's/X(OBJ, obj)/& X(STL, stl)/' export/export.c
plant 'half a bound of shapes' scene/collider.h 's/^    CS_BOUNDS_BOX,/    CS_BOUNDS_TORUS, &/' model/contact/posed_collider.c
plant 'half a colouring' draw/look.h 's/^    CS_COLOURS_FAINT,/    CS_COLOURS_DEPTH, &/' draw/look.c
echo "1..$n"
[ $n = 6 ] || failed=1
exit $failed
