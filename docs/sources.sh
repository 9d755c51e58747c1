#!/bin/sh
# sources.sh [--cheap] [DIR] - runs the command of every row of sources.md in a folder of its own below DIR
# (build/sources), and prints a line a row. A row fails if its command does, if a figure in **bold** is not in
# what it prints, or if it has neither a command nor the words "out of reach". --cheap leaves out rows whose number
# ends in *. PROGRAM: which clothsim.
set -eu

here=$(cd "$(dirname "$0")/.." && pwd)
program=$(realpath "${PROGRAM:-$here/build/clothsim}")
cheap=false
[ "${1:-}" != --cheap ] || { cheap=true && shift; }
out=${1:-$here/build/sources}
mkdir -p "$out/bin"
out=$(realpath "$out")
printf '#!/bin/sh\nexec %s "$@"\n' "$program" >"$out/bin/clothsim"
chmod +x "$out/bin/clothsim"
export PATH="$out/bin:$PATH"

# number, command and bold figures of each row, between tabs
rows() {
    awk -F ' *[|] *' '$2 ~ /^[ACFS][0-9]+[*]?$/ {
        command = figures = ""
        if (match($4, /`[^`]*`/)) command = substr($4, RSTART + 1, RLENGTH - 2)
        else if ($4 ~ /out of reach/) command = "out of reach"
        for (rest = $6; match(rest, /[*][*][^*]*[*][*]/); rest = substr(rest, RSTART + RLENGTH))
            figures = figures (figures == "" ? "" : ";") substr(rest, RSTART + 2, RLENGTH - 4)
        printf "%s\t%s\t%s\n", $2, command == "" ? "-" : command, figures
    }' "$here/docs/sources.md"
}

# row NUMBER COMMAND FIGURES
row() {
    folder=$out/${1%\*}
    rm -rf "$folder"
    mkdir "$folder"
    ln -s "$here/scenes" "$here/docs" "$folder"
    (cd "$folder" && eval "$2") >"$folder/log" 2>&1 </dev/null || {
        echo "not ok $1 - $2"
        sed 's/^/#   /' "$folder/log"
        return 1
    }
    rest="$3;"
    while [ "$rest" != ";" ] && [ -n "$rest" ]; do
        figure=${rest%%;*} rest=${rest#*;}
        grep -qF -- "$figure" "$folder/log" || {
            echo "not ok $1 - $2: no \"$figure\" in"
            sed 's/^/#   /' "$folder/log"
            return 1
        }
    done
    echo "ok $1 - $2"
}

failed=0 n=0
rows >"$out/rows"
tab=$(printf '\t')
while IFS=$tab read -r number command figures; do
    case $number$cheap in *\*true) continue ;; esac
    n=$((n + 1))
    case $command in
        "out of reach") echo "ok $number - out of reach" ;;
        -) echo "not ok $number - no command" && failed=1 ;;
        *) row "$number" "$command" "$figures" || failed=1 ;;
    esac
done <"$out/rows"
echo "1..$n"
exit $failed
