#!/bin/sh
# cases.sh PROGRAM FILE.case ... - runs command lines and compares what they print (as TAP).
#
# A case is a block between blank lines; its lines start with
#   #  what the case shows
#   <  NAME TEXT: a file of one line; << NAME ... <<: a file of the lines between
#   $  a command line of the shell; clothsim is the program under test, and stop_at SIGNAL FILE[:BYTES]
#      COMMAND... sends it a signal as soon as a file is there
#   !  the exit code where it is not 0
# and every other line is expected output, standard error among standard output as it comes.
# "..." stands for any text within a line, and alone on a line for any number of lines.
# Of a command that fails the lines that differ are printed, and no others.
# Each case has an own empty folder, with the project's scenes/ and golden/ in it.
set -eu

program=$(realpath "$1")
shift
root=$(cd "$(dirname "$0")/../.." && pwd)
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 1' INT TERM

mkdir "$work/bin"
ln -s "$program" "$work/bin/clothsim"
ln -s "$here/stop_at.py" "$work/bin/stop_at"
# not one that a shell script finds first: that takes five times as long to start
ln -s /usr/bin/python3 "$work/bin/python3"
PATH=$work/bin:$PATH
export PATH LC_ALL=C
unset CLOTHSIM_PLUGIN_PATH
# only read in builds with a sanitizer
export LSAN_OPTIONS="suppressions=$here/leaks.supp:print_suppressions=0"

n=0 failed=0
for file; do
    rm -rf "$work/cases"
    mkdir "$work/cases"
    awk -v work="$work/cases" -f "$here/split.awk" "$file"
    for case in "$work"/cases/*; do
        n=$((n + 1))
        ln -s "$root/scenes" "$root/golden" "$case/folder"
        verdict=ok
        for command in "$case"/*.command; do
            step=${command%.command}
            code=0
            read -r expected <"$step.code"
            (cd "$case/folder" && sh "$command") >"$step.output" 2>&1 </dev/null || code=$?
            fits=yes
            awk -f "$here/match.awk" "$step.expected" "$step.output" >"$step.difference" || fits=no
            if [ "$code" != "$expected" ] || [ $fits = no ]; then
                verdict="not ok" failed=1
                {
                    printf '$ %s\n' "$(cat "$command")"
                    [ "$code" = "$expected" ] || echo "exit code $code, expected $expected"
                    cat "$step.difference"
                } >>"$case/log"
            fi
        done
        echo "$verdict $n - $(basename "$file" .case): $(cat "$case/title")"
        # on standard error, which a failed test's log shows whatever reads the TAP
        [ ! -f "$case/log" ] || sed 's/^/#   /' "$case/log" >&2
    done
done
echo "1..$n"
exit $failed
