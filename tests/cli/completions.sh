#!/bin/sh
# completions.sh PROGRAM FOLDER - the scripts in FOLDER offer every option of every command, as each
# shell that is here completes it (as TAP).
set -eu
export LC_ALL=C

program=$(realpath "$1") folder=$(realpath "$2")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 1' INT TERM

mkdir "$work/bin"
ln -s "$program" "$work/bin/clothsim"
PATH=$work/bin:$PATH
HOME=$work
export PATH HOME

# what bash would offer behind the words given
cat >"$work/offer.bash" <<'BASH'
source "$1/clothsim.bash"
shift
COMP_WORDS=(clothsim "$@") COMP_CWORD=$#
_clothsim
printf '%s\n' "${COMPREPLY[@]}"
BASH

# zsh's own _arguments needs a terminal: what it is given is printed instead
cat >"$work/offer.zsh" <<'ZSH'
_arguments() { print -l -- "$@" }
_describe() { print -l -- ${commands%%:*} }
compadd() { print -l -- $methods }
words=(clothsim "${@:2}") CURRENT=$#
source $1/_clothsim
ZSH

bash_offers() { bash "$work/offer.bash" "$folder" "$@"; }
# '(-n --frames)--frames=[text]:N: ' and '*-s+[text]:PATH=VALUE: ' are --frames and -s
zsh_offers() {
    zsh -f "$work/offer.zsh" "$folder" "$@" |
        sed 's/^([^)]*)//; s/^\*\(-\)/\1/; s/[+=]*\[.*//'
}
fish_offers() {
    fish --no-config -c "source $folder/clothsim.fish; complete -C 'clothsim $*'" | cut -f 1
}

n=0 failed=0
# told NAME: what is expected, in the file "expected", is in the file "offered"
told() {
    n=$((n + 1))
    sort -u "$work/offered" >"$work/sorted"
    if sort -u "$work/expected" | comm -23 - "$work/sorted" >"$work/missing" &&
        [ -s "$work/expected" ] && ! [ -s "$work/missing" ]; then
        echo "ok $n - $1"
    else
        failed=1
        echo "not ok $n - $1 lacks"
        sed 's/^/#   /' "$work/missing"
    fi
}

commands=$("$program" help | sed -n 's/^  \([a-z-]*\)  .*/\1/p')
for shell in bash zsh fish; do
    command -v $shell >/dev/null || continue
    echo "$commands" >"$work/expected"
    ${shell}_offers "" >"$work/offered"
    told "$shell: commands"
    for command in $commands; do
        [ "$command" != help ] || continue
        "$program" "$command" --help |
            sed -n 's/^  \(-[a-zA-Z]\)\?,\? *\(--[a-z-]*\).*/\1 \2/p' | tr -s ' ' '\n' |
            grep . >"$work/expected"
        : >"$work/offered"
        for start in - --; do ${shell}_offers "$command" "$start" >>"$work/offered"; done
        told "$shell: options of $command"
    done
done

# values: the methods there are
"$program" integrators | sed -n 's/^\([a-z][a-z0-9-]*\) .*/\1/p' >"$work/expected"
bash_offers run -i "" >"$work/offered"
told "bash: methods"
if command -v fish >/dev/null; then
    fish_offers "run -i " >"$work/offered"
    told "fish: methods"
fi
echo "1..$n"
exit $failed
