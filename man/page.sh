#!/bin/sh
# page.sh SCDOC SOURCE [PROGRAM] - one man page to standard output; a line @KEYS@ of the source
# stands for the program's own list of scene keys, @FILES@ of what it writes, @COMMANDS@ of its commands, @GLOSSARY@
# for the table of docs/glossary.md. No page where the program or scdoc fails: a pipe tells only how
# its last command ended.
set -eu

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 1' INT TERM

commands() {
    "$1" help >"$work/help" && awk '
        /^  help / { exit }
        /^  [a-z]/ { name = $1; sub(/^  [a-z-]+ +/, ""); text[++n] = $0; names[n] = name; next }
        n && /^ +/ { sub(/^ +/, " "); text[n] = text[n] $0 }
        END {
            for (i = 1; i <= n; i++)
                printf "%s*%s*\n\t%s%s. See *clothsim-%s*(1).\n", (i > 1 ? "\n" : ""), names[i],
                    toupper(substr(text[i], 1, 1)), substr(text[i], 2), names[i]
        }' "$work/help"
}

# rows "| term | meaning |"; `code` and *emphasis* are bold
glossary() {
    sed -n 's/^| \(.*\) | \(.*\) |$/\1\t\2/p' "$1" | sed 1d | sed 's/_/\\_/g; s/`/*/g' |
        awk -F '\t' '{ printf "%s*%s*\n\t%s.\n", (NR > 1 ? "\n" : ""), $1,
            toupper(substr($2, 1, 1)) substr($2, 2) }'
}

sed '/^@[A-Z]*@$/,$d' "$2" >"$work/source"
case $(grep '^@[A-Z]*@$' "$2") in
@KEYS@) "$3" scene --manual >>"$work/source" ;;
@FILES@) "$3" --files >>"$work/source" ;;
@COMMANDS@) commands "$3" >>"$work/source" ;;
@GLOSSARY@) glossary "$(dirname "$2")/../docs/glossary.md" >>"$work/source" ;;
esac
sed '1,/^@[A-Z]*@$/d' "$2" >"$work/rest"
cat "$work/rest" >>"$work/source"
"$1" <"$work/source" >"$work/page" || {
    echo "page.sh: scdoc fails on $2 (a line number above is that of the page with its keys)" >&2
    exit 1
}
awk '
    # scdoc puts a .P round every block: it means nothing at headings, and belongs behind .RE
    $0 == ".P" { waiting = !heading; next }
    $0 == ".RE" { print; next }
    { heading = /^\.S[HS]/ }
    waiting && !heading { print ".P" }
    { waiting = 0; print }' "$work/page"
