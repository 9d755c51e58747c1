#!/bin/sh
# cross.sh [MACHINE-COMPILER-LEVEL ...] - some golden rows with these builds, or with those below: the runs
# that rows.tsv lists, and the pictures that it names, drawn by cpu. Machines of both byte orders and of
# 32 and 64 bits, two compilers, two C libraries, all levels of optimisation, each with 1, 4 and 16
# threads. Others than amd64 run under qemu-user. Clang is not asked for mips: Debian's finds gcc's own
# headers there.
set -eu
cd "$(dirname "$0")/../.."
folder=$PWD/build/cross threads="1 4 16"
[ $# -gt 0 ] || set -- amd64-gcc-O3 amd64-clang-O2 musl-gcc-O3 musl-gcc-O0 \
    aarch64-gcc-O3 aarch64-gcc-O0 aarch64-clang-O2 armhf-gcc-O2 armhf-clang-O3 \
    i386-gcc-O3 i386-clang-O1 s390x-gcc-O2 s390x-clang-O3 riscv64-gcc-O1 riscv64-clang-O2 \
    mips-gcc-O2 mips-gcc-O1
[ ! -d /usr/lib/ccache ] || PATH=/usr/lib/ccache:$PATH

# the file and the program to run its programs with, of a machine
triple_of() { sed -n "s/^triple = '\(.*\)'/\1/p" "tests/cross/$1.ini"; }
qemu_of() { sed -n "s/^exe_wrapper = \['\([^']*\)'.*/\1/p" "tests/cross/$1.ini"; }

# options BUILD: those of meson setup for the machine and its compiler
options() {
    machine=${1%%-*} compiler=${1#*-}
    compiler=${compiler%-*}
    [ "$machine" = amd64 ] || echo "--cross-file tests/cross/$machine.ini"
    [ "$machine" = amd64 ] || [ "$compiler" = gcc ] || echo "--cross-file tests/cross/$compiler.ini"
}

# libraries, if they are not Debian's own, and the program with the modules that need none
build() {
    machine=${1%%-*} build=$folder/$1 compiler=${1#*-}
    if [ "$machine" != amd64 ]; then
        triple=$(triple_of "$machine")
        cc=$(sed -n "s/^c_args = \[\(.*\)\]/\1/p" "tests/cross/$machine.ini" | tr -d "',")
        if [ "$machine" = musl ]; then cc="musl-gcc $cc"; else cc="$triple-gcc $cc"; fi
        tests/cross/libraries.sh "$folder" "$triple" $cc || return 1
        export PKG_CONFIG_LIBDIR="$folder/$triple/lib/pkgconfig"
    fi
    [ -f "$build/build.ninja" ] || CC=${compiler%-*} meson setup "$build" $(options "$1") \
        -Dwerror=true -Doptimization="${1##*-O}" -Ddebug=false -Dsundials=disabled -Dcholmod=disabled \
        -Drender=disabled -Dman=disabled -Dtests=disabled || return 1
    ninja -C "$build" tools/clothsim-golden $(ninja -C "$build" -t targets all | sed -n 's/: .*//p' |
        grep -xE '(plugins/[^/]*|src/draw/(render-cpu|png-libpng))[.]so')
}

mkdir -p "$folder/table/golden"
ln -sfn "$PWD/scenes" "$folder/table/scenes"
ln -sfn "$PWD/golden/image" "$folder/table/golden/image"
ln -sfn "$PWD/golden/state" "$folder/table/golden/state"
# selected TABLE FIELDS KEY: rows of a golden table that rows.tsv names in lines of so many fields
selected() {
    awk -F '\t' -v fields="$2" "NR == FNR { if (NF == fields) { wanted[\$0]; n++ } next }
        FNR == 1 || ($3) in wanted { print; found += FNR > 1 }
        END { exit found != n }" tests/cross/rows.tsv "golden/$1" >"$folder/table/golden/$1" || {
        echo "cross.sh: a row of rows.tsv is not in golden/$1, or is there twice" >&2
        exit 1
    }
}
selected hash.tsv 3 '$6 == "any" ? $1 FS $2 FS $4 : ""'
selected image.tsv 1 '$5'
for name; do
    (build "$name") >"$folder/$name.log" 2>&1 || { tail -n 40 "$folder/$name.log" >&2 && exit 1; }
done

begin=$(date +%s)
for name; do
    machine=${name%%-*} wrapper=
    case $machine in
        amd64 | musl) ;;
        # the C library of the loader: the cache may name another one of this machine, and a libc
        # beside a loader of another build does not return from pthread_create
        *) root=/usr/$(triple_of "$machine")
            wrapper="$(qemu_of "$machine") -L $root -E LD_LIBRARY_PATH=$root/lib" ;;
    esac
    # an emulator starts no second program
    for n in $threads; do echo "$name $n $wrapper $folder/$name/tools/clothsim-golden"; done
done | xargs -P "$(nproc)" -L 1 sh -c '
    name=$1 n=$2
    shift 2
    code=0
    found=$("$@" golden --renderer cpu --quiet --threads "$n" --folder "$0/table/golden" 2>&1) || code=$?
    printf "%-16s %2d threads: %s\n" "$name" "$n" "$found"
    exit $code' "$folder"
set -- "$@"
echo "$(($# * $(echo $threads | wc -w))) cells agree, in $(($(date +%s) - begin)) s"
