#!/bin/sh
# no_proc.sh PROGRAM - where /proc is not mounted, as in a chroot: the program finds its modules by the
# path that it was started by, and by the folder that was configured where there is no such file, which
# it says (as TAP). Needs a mount namespace of its own.
set -eu
export LC_ALL=C

program=$(realpath "$1")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 1' INT TERM
if ! unshare -m mount -t tmpfs none /proc 2>/dev/null; then
    echo "1..0 # SKIP no mount namespace here"
    exit 0
fi

n=0 failed=0
told() { # NAME CODE
    n=$((n + 1))
    if [ "$2" -eq 0 ]; then echo "ok $n - $1"; else
        failed=1
        echo "not ok $n - $1"
        sed 's/^/#   /' "$work/out" "$work/err"
    fi
}

# hidden COMMAND ...: without /proc, in the folder of the program, by a relative path
hidden() {
    (cd "$(dirname "$program")" && unshare -m sh -c 'mount -t tmpfs none /proc && exec "$@"' sh "$@") \
        >"$work/out" 2>"$work/err"
}

code=0
hidden "./$(basename "$program")" integrators rk4 || code=1
grep -q '^name *rk4' "$work/out" || code=1
[ ! -s "$work/err" ] || code=1
told "modules are found by the path of the start" $code

code=0
hidden /usr/bin/python3 -c 'import os, sys
program = os.open(sys.argv[1], os.O_RDONLY)
os.execve(program, ["clothsim", "--version"], {})' "$program" || code=1
grep -q '^clothsim [0-9]' "$work/out" || code=1
grep -q '^clothsim: the system does not tell where this program is (no /proc): methods are taken from /' \
    "$work/err" || code=1
told "the configured folders are named where the path is unknown" $code
echo "1..$n"
exit $failed
