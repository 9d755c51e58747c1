#!/bin/sh
# elsewhere.sh [SUITE ...] - Debian 12, 13 and sid, or the suites named, each in a tree of its own that
# debootstrap makes (once, in build/elsewhere): the program with all that the distribution has, by gcc
# and by clang, and all golden hashes. /proc is not mounted there. Needs root and a Debian mirror.
set -eu
cd "$(dirname "$0")/../.."
folder=$PWD/build/elsewhere
mirror=${MIRROR:-http://deb.debian.org/debian}
packages="$PACKAGES"
[ $# -gt 0 ] || set -- bookworm trixie sid
mkdir -p "$folder"

# tree SUITE: with the packages, of which one that is optional may not exist there
tree() {
    root=$folder/$1
    [ -f "$root/etc/debian_version" ] || debootstrap --variant=minbase "$1" "$root" "$mirror" || return 1
    chroot "$root" sh -c 'apt-get update -qq -o Acquire::Check-Valid-Until=false
        for package; do apt-cache show "$package" >/dev/null 2>&1 && echo "$package"; done >/packages
        DEBIAN_FRONTEND=noninteractive xargs apt-get install -y -qq --no-install-recommends </packages' \
        sh $packages || return 1
    rm -rf "$root/clothsim"
    mkdir -p "$root/clothsim"
    git ls-files -z | xargs -0 tar -c | tar -x -C "$root/clothsim"
}

# rust SUITE: the client in Rust gives the bits of rk4, by the compiler of that distribution
rust() {
    chroot "$folder/$1" sh -ec 'cd /tmp
        rustc --edition 2021 -O /clothsim/examples/rk4_program.rs
        for method in rk4 program:./rk4_program; do
            /build/gcc/clothsim run /clothsim/scenes/drum.json -n 3 --no-render -y -i $method:dt=0.0005 |
                grep "^state hash"
        done | uniq | wc -l | grep -qx 1'
}

# build SUITE COMPILER
build() {
    chroot "$folder/$1" sh -c 'cd /clothsim && { [ -f "/build/$1/build.ninja" ] || CC=$1 meson setup \
        "/build/$1" -Dwerror=true -Ddebug=false -Dtests=disabled -Dman=disabled; } && ninja -C "/build/$1"' \
        sh "$2"
}

code=0
for suite; do
    tree "$suite" >"$folder/$suite.log" 2>&1 || { tail -n 20 "$folder/$suite.log" >&2 && exit 1; }
    for compiler in gcc clang; do
        log=$folder/$suite-$compiler.log
        if build "$suite" "$compiler" >"$log" 2>&1; then
            found=$(chroot "$folder/$suite" sh -c 'cd /clothsim && "/build/$1/clothsim" golden --hashes --quiet' \
                sh "$compiler" 2>&1 | tail -n 1)
            case $found in *" 0 differ"*) ;; *) code=1 ;; esac
            [ "$compiler" = clang ] || rust "$suite" >>"$log" 2>&1 || { code=1 found="$found; no Rust"; }
        else
            tail -n 20 "$log" >&2
            code=1 found="does not build"
        fi
        without=$(sed -n 's/ : *NO.*/ missing/p' "$log" | tr -s ' ' | tr '\n' ';')
        printf '%-9s %-6s %-8s %s%s\n' "$suite" "$compiler" \
            "$(chroot "$folder/$suite" "$compiler" -dumpversion)" "$found" "${without:+;$without}"
    done
done
exit $code
