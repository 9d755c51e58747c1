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

# what several commands have: one letter a name, one name a letter (but for one method or several),
# and the table of clothsim(1)
for command in $("$program" help | sed -n 's/^  \([a-z-]*\)  .*/\1/p' | grep -v help); do
    "$program" "$command" --help |
        sed -n "s/^  \(-[a-z], \)\? *--\([a-z-]*\).*/\2 \1$command/p"
done >"$work/options"
sort -k1,1 -k3,3 "$work/options" | awk '
    {
        letter = NF == 3 ? substr($2, 2, 1) : ""
        if ($1 in n && letters[$1] != letter) print "--" $1 " has two letters"
        n[$1]++
        letters[$1] = letter
        known = owner[letter]
        if (letter && known && known != $1 && letter != "i")
            print "-" letter " is --" known " and --" $1
        owner[letter] = $1
    }' >"$work/a"
: >"$work/b"
same "one letter a name, one name a letter"
sort -k1,1 "$work/options" | awk '
    $1 != "help" { n[$1]++; of[$1] = of[$1] " " $NF; letter[$1] = NF == 3 ? $2 " " : "" }
    END { for (name in n) if (n[name] > 1) print letter[name] "--" name of[name] }' |
    sort >"$work/a"
sed -n '/^# SHARED OPTIONS/,/^# WHY/p' "$root/man/clothsim.1.scd" | tr -d '*' | awk '
    /^-/ { name = $0; sub(/ _.*/, "", name); next }
    /^\t/ { text = text $0; if (/\.$/) { sub(/.*:/, "", text); gsub(/[,.\t]/, " ", text)
        gsub(/ +/, " ", text); sub(/ $/, "", text); if (name !~ /--help/) print name text; text = "" } }' |
    sort >"$work/b"
same "shared options in clothsim(1)"

sed -n 's/^    X(CS_[A-Z_]*, \([0-9]*\), "\(.*\)").*/\1 \2/p' "$root/src/base/status.h" >"$work/a"
sed -n '/^# EXIT STATUS/,/^# ENV/p' "$root/man/clothsim.1.scd" |
    awk '/^\*[0-9]+\*$/ { code = $0; gsub(/\*/, "", code) } /^\t/ { sub(/^\t/, ""); print code, $0 }' \
    >"$work/b"
same "exit codes"

# formats of exports, in the order of the program: --help, clothsim-run(1), clothsim-files(5)
printf '{"bodies": [{"cloth": {"grid": [2, 2]}, "mass": {"total": 1}}]}' >"$work/scene.json"
"$program" run "$work/scene.json" --export none 2>&1 |
    sed -n 's/.*one or more of \(.*\), separated.*/\1/p' | tr -d ',' | tr ' ' '\n' >"$work/formats"
for page in help run.1 files.5; do
    if [ $page = help ]; then
        "$program" run --help
    else
        cat "$root/man/clothsim-$page.scd"
    fi >"$work/page"
    sed 's/.*/& is named/' "$work/formats" >"$work/a"
    while read -r format; do
        ! grep -qw -- "$format" "$work/page" || echo "$format is named"
    done <"$work/formats" >"$work/b"
    [ -s "$work/a" ] || echo "no format" >"$work/a"
    same "formats of --export in $page"
done

echo "1..$n"
exit $failed
