#!/bin/sh
# arithmetic.sh ROOT CC [ARG ...] - flags that change values are found by computing, and flags that
# change none are not (as TAP). What a compiler or processor does not know is left out.
set -u
root=$1
shift
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
n=0 failed=0

# expect fault|none FLAG ...: whether a build with these flags is at fault
expect() {
    wanted=$1
    shift
    "$@" -DCS_ARITHMETIC_ALONE -o "$work/sums" "$root/src/cli/ieee_check.c" -lm 2>/dev/null ||
        return 0
    if said=$("$work/sums"); then found=none; else found=fault; fi
    n=$((n + 1))
    if [ $found = "$wanted" ]; then
        echo "ok $n - $*: ${said:-none}"
    else
        echo "not ok $n - $*: ${said:-none}, expected $wanted"
        failed=1
    fi
}

for level in -O0 -O2 -O3; do
    expect none "$@" $level -ffp-contract=off
    expect none "$@" $level -ffp-contract=off -fno-math-errno -fno-trapping-math
done
for flag in -ffast-math -Ofast -funsafe-math-optimizations -freciprocal-math \
    -fno-signed-zeros; do
    expect fault "$@" -O2 -ffp-contract=off $flag
done
if grep -qw fma /proc/cpuinfo 2>/dev/null; then
    expect fault "$@" -O2 -mfma -ffp-contract=fast
    expect none "$@" -O2 -mfma -ffp-contract=off
fi
# a builder's own flags come last in the build, and so in the check made when it is configured
refuse() {
    n=$((n + 1))
    if CC=$compiler meson setup "$work/build" "$root" "-Dc_args=$1" >"$work/log" 2>&1; then
        echo "not ok $n - meson setup takes c_args=$1"
        failed=1
    elif grep -q 'promises the same bits' "$work/log"; then
        echo "ok $n - meson setup refuses c_args=$1"
    else
        echo "not ok $n - meson setup fails with c_args=$1, and not for its arithmetic"
        failed=1
    fi
    rm -rf "$work/build"
}
compiler=$*
refuse -Ofast
refuse -fno-signed-zeros
grep -qw fma /proc/cpuinfo 2>/dev/null && refuse '-mfma -ffp-contract=fast'

echo "1..$n"
[ $n -gt 3 ] || failed=1
exit $failed
