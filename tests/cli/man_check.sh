#!/bin/sh
# man_check.sh PROGRAM - the man pages say what the program has: its options and its exit codes (as
# TAP). Its commands stand in clothsim(1) by the build.
set -eu

program=$1
root=$(cd "$(dirname "$0")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 1' INT TERM

n=0 failed=0
same() { # NAME: the lists a and b are equal
    n=$((n + 1))
    if cmp -s "$work/a" "$work/b"; then
        echo "ok $n - $1"
    else
        failed=1
        echo "not ok $n - $1"
        diff "$work/a" "$work/b" | sed 's/^/#   /' || true
    fi
}

for command in $("$program" help | sed -n 's/^  \([a-z-]*\)  .*/\1/p' | grep -v help); do
    page=$root/man/clothsim-$command.1.scd
    "$program" "$command" --help |
        sed -n 's/^  \(-[a-z], \)\? *\(--[a-z-]*\)\( [^ ]*\)\?.*/\1\2/p' | sort >"$work/a"
    sed -n '/^# OPTIONS/,/^# [E-Z]/s/^\(\*-.*\)/\1/p' "$page" | tr -d '*' |
        sed 's/\(--[a-z-]*\).*/\1/' | sort >"$work/b"
    same "options of $command"
done

sed -n 's/^    X(CS_[A-Z_]*, \([0-9]*\), "\(.*\)").*/\1 \2/p' "$root/src/base/status.h" >"$work/a"
sed -n '/^# EXIT STATUS/,/^# ENV/p' "$root/man/clothsim.1.scd" |
    awk '/^\*[0-9]+\*$/ { code = $0; gsub(/\*/, "", code) } /^\t/ { sub(/^\t/, ""); print code, $0 }' \
    >"$work/b"
same "exit codes"

echo "1..$n"
exit $failed
