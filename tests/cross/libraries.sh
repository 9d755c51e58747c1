#!/bin/sh
# libraries.sh FOLDER TRIPLE CC [ARG ...] - cJSON, libpng, zlib and xxHash in FOLDER/TRIPLE, as static
# libraries for a machine that Debian need not have packages of. Their sources are those of Debian,
# taken by a configuration of apt that is FOLDER's own.
set -eu
folder=$1 triple=$2
shift 2
sources=$folder/sources
mkdir -p "$sources"

# apt-get of another list of sources and another state
own_apt() {
    apt-get -q -o Dir::Etc::SourceList="$sources/apt/list" -o Dir::Etc::SourceParts=/dev/null \
        -o Dir::State::Lists="$sources/apt/lists" -o Dir::Cache="$sources/apt" \
        -o APT::Sandbox::User=root "$@"
}

fetch() {
    mkdir -p "$sources/apt/lists/partial" "$sources/apt/archives/partial"
    key=/usr/share/keyrings/debian-archive-keyring.gpg
    echo "deb-src [signed-by=$key] http://deb.debian.org/debian bookworm main" >"$sources/apt/list"
    own_apt update
    (cd "$sources" && own_apt source --download-only cjson libpng1.6 zlib xxhash)
    for name in cjson libpng1.6 zlib xxhash; do
        rm -rf "$sources/$name"
        dpkg-source --no-check -x "$sources/$name"_*.dsc "$sources/$name"
    done
    cp "$sources/libpng1.6/scripts/pnglibconf.h.prebuilt" "$sources/libpng1.6/pnglibconf.h"
    touch "$sources/done"
}

# library NAME VERSION REQUIRES FILE ... : an archive, and what pkg-config says of it
library() {
    name=$1 version=$2 requires=$3
    shift 3
    objects=
    for file; do
        object=$work/$name-$(basename "$file" .c).o
        $cc -O2 -fPIC -I"$sources/zlib" -DPNG_ARM_NEON_OPT=0 -DPNG_MIPS_MSA_OPT=0 -c -o "$object" "$file"
        objects="$objects $object"
    done
    ar rcs "$lib/lib$name.a" $objects
    case $name in z) package=zlib ;; *) package=lib$name ;; esac
    cat >"$lib/pkgconfig/$package.pc" <<PC
Name: $name
Description: for $triple
Version: $version
Requires: $requires
Cflags: -I$folder/$triple/include
Libs: -L$lib -l$name
PC
}

cc="$*" lib=$folder/$triple/lib
[ ! -f "$lib/done" ] || exit 0
[ -f "$sources/done" ] || fetch >"$sources/log" 2>&1 || { cat "$sources/log" >&2 && exit 1; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$lib/pkgconfig" "$folder/$triple/include/cjson"
cp "$sources/cjson/cJSON.h" "$folder/$triple/include/cjson"
cp "$sources/cjson/cJSON.h" "$sources"/zlib/z*.h "$sources/xxhash/xxhash.h" "$sources"/libpng1.6/png*.h \
    "$folder/$triple/include"
cd "$sources"
library cjson 1.7.15 "" cjson/cJSON.c
library z 1.2.13 "" $(printf 'zlib/%s.c ' adler32 compress crc32 deflate infback inffast inflate \
    inftrees trees uncompr zutil)
library png 1.6.39 zlib $(ls libpng1.6/png*.c | grep -v pngtest)
library xxhash 0.8.1 "" xxhash/xxhash.c
touch "$lib/done"
