#!/bin/sh
# outside.sh SOURCE BUILD - what an outsider does: installs clothsim, builds the template module
# against what was installed, with nothing but pkg-config, and runs it and its card; and uses what
# was installed with it from a folder that has nothing of it.
set -eu

source=$1 build=$2
command -v pkg-config >/dev/null || exit 77
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 1' INT TERM

DESTDIR=$work/root meson install -C "$build" --no-rebuild --quiet
pc=$(find "$work/root" -name clothsim.pc)
program=$(find "$work/root" -type f -path '*/bin/clothsim')
example=$(find "$work/root" -path '*/doc/clothsim/template.c')
[ -n "$pc" ] && [ -n "$program" ] && [ -n "$example" ]

# the prefix as it was installed lies under the work folder
PKG_CONFIG_LIBDIR=$(dirname "$pc")
PKG_CONFIG_SYSROOT_DIR=$work/root
export PKG_CONFIG_LIBDIR PKG_CONFIG_SYSROOT_DIR
unset PKG_CONFIG_PATH CPATH

flags=$(pkg-config --cflags clothsim)
case $flags in *-ffp-contract=off*) ;; *) echo "no -ffp-contract=off in: $flags"; exit 1 ;; esac
[ "$(pkg-config --variable=abi clothsim)" = 1 ]
modules=$(pkg-config --variable=plugindir clothsim)
case $modules in "$work"/root*) ;; *) modules=$work/root$modules ;; esac
[ -f "$modules/explicit.so" ]

# the template is an example, not one of the modules
[ ! -e "$modules/template.so" ]
cd "$work"
cp "$example" mine.c
# shellcheck disable=SC2086
"${CC:-cc}" -std=c17 -Wall -Wextra -Werror -O2 -shared -fPIC $flags -o mine.so mine.c -lm

"$program" integrators --plugin mine.so midpoint | grep -q '^order  *2$'
"$program" run "$source/scenes/hang.json" --frames 2 --no-render --quiet --hash \
    --plugin mine.so --integrator midpoint:dt=0.0002 >hashes
[ "$(wc -l <hashes)" -ge 2 ]
# a module file in the place of a name, but never by a scene
"$program" run "$source/scenes/hang.json" --frames 2 --no-render --quiet --hash \
    --integrator ./mine.so:dt=0.0002 | cmp - hashes
if "$program" scene "$source/scenes/hang.json" --set 'integrator="./mine.so"' 2>refused; then exit 1; fi
grep -q 'integrator: found "./mine.so", expected a name' refused
"$program" conform mine.so | tee card
grep -q ' 0 fail, 0 expected, 0 stale' card
# and the installed program gives its own modules a card
"$program" conform --quiet --only order velocity-verlet

# the same method in C++, by two compilers: the same bits
for compiler in g++ clang++; do
    # shellcheck disable=SC2086
    $compiler -std=c++17 -Wall -Wextra -Wpedantic -Werror -O2 -shared -fPIC $flags -o cxx.so "${example}pp"
    "$program" run "$source/scenes/hang.json" --frames 2 --no-render --quiet --hash \
        --plugin cxx.so --integrator midpoint:dt=0.0002 | cmp - hashes
done
"$program" integrators --plugin cxx.so midpoint | grep -q '^ *dt '

# documents, and scenes and golden tables from any folder
documents=$(dirname "$example")
for file in LICENSE README.md CHANGELOG.md docs/compare.md; do [ -s "$documents/$file" ]; done
for file in clothsim.bash _clothsim clothsim.fish; do
    [ -s "$(find "$work/root" -name $file)" ]
done
mkdir empty
cd empty
"$program" run scenes/hang.json --frames 2 --no-render --quiet --hash \
    --plugin ../mine.so --integrator midpoint:dt=0.0002 | cmp - ../hashes
"$program" golden --hashes --quiet --only free_fall | grep -q '^[0-9]* agree, [0-9]* differ, 0 accepted'
"$program" scene "scenes/extreme/$(ls "$source/scenes/extreme" | grep -m 1 json)" | grep -q ': ok, '
if "$program" golden --accept --hashes 2>../refused; then exit 1; fi
grep -q 'golden/hash.tsv' ../refused

# a method whose library the build was without is told from a misspelt one
echo 'made-up-bdf SUNDIALS (Debian: libsundials-dev)' >>"$modules/left-out.txt"
if "$program" integrators made-up-bdf 2>../refused; then exit 1; fi
grep -qx 'clothsim: integrator "made-up-bdf" needs SUNDIALS (Debian: libsundials-dev), which this clothsim was built without' ../refused

# the build's list names every method and its module, which alone is opened then
"$program" integrators | sed -n 's/^\([a-z0-9-]\{1,\}\)  *order .*/\1/p' | sort >../found
cut -d ' ' -f 1 "$modules/modules.txt" | sort | cmp - ../found
while read -r method module; do
    grep -q "$method" "$modules/$module"
done <"$modules/modules.txt"
cp "$modules/explicit.so" "$modules/a-copy.so"
"$program" integrators rk4 | grep -q '^module .*/explicit.so$'
"$program" integrators | grep -q 'refused: .*/a-copy.so: integrator "[a-z0-9-]*" is already in .*/explicit.so'
# and without it the modules are searched
rm "$modules/modules.txt"
"$program" integrators rk4 | grep -q '^module .*/a-copy.so$'
