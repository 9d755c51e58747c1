#!/bin/sh
# outside.sh SOURCE BUILD - what an outsider does: installs clothsim, builds the template module
# against what was installed, with nothing but pkg-config, and runs it and its card.
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
"$program" conform mine.so | tee card
grep -q ' 0 fail, 0 expected, 0 stale' card
# and the installed program gives its own modules a card
"$program" conform --quiet --only order velocity-verlet
