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
COMP_WORDBREAKS=$' \t\n"\'><=;|&(:' COMP_LINE="clothsim $*"
COMP_POINT=${#COMP_LINE}
compopt() { :; } # which holds only while bash itself completes
_clothsim
printf '%s\n' "${COMPREPLY[@]}"
BASH

# zsh's own _arguments needs a terminal: what it is given is printed instead
cat >"$work/offer.zsh" <<'ZSH'
_arguments() { print -l -- "$@" }
_describe() { print -l -- ${commands%%:*} }
compadd() { print -l -- $values }
_files() { : }
words=(clothsim "${@:2}") CURRENT=$#
source $1/_clothsim
ZSH

bash_offers() { bash "$work/offer.bash" "$folder" "$@"; }
# '(-n --frames)--frames=[text]:N: ' and '*-s+[text]:PATH=VALUE: ' are --frames and -s
zsh_offers() {
    zsh -f "$work/offer.zsh" "$folder" "$@" |
        sed 's/^([^)]*)//; s/^\*\(-\)/\1/; s/[+=]*\[.*//'
}
# VALUES COMMAND --OPTION WORD: by the function that the script gives to zsh for them
zsh_values() {
    printf '%s\n' 'words=(clothsim "") CURRENT=2' 'source $1/_clothsim >/dev/null' \
        'PREFIX=$4; _clothsim_values $2 $3' >"$work/values.zsh"
    { sed -n '/^_arguments/,/^compadd/p; /^_files/p' "$work/offer.zsh" && cat "$work/values.zsh"; } \
        >"$work/both.zsh"
    zsh -f "$work/both.zsh" "$folder" "$@"
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

# offers SHELL COMMAND OPTION WORD: what it offers as a value, without what bash has of the word already
offers() {
    case $1 in
    bash) bash_offers "$2" "$3" "$4" ;;
    zsh) zsh_values "$2" "$3" "$4" ;;
    fish) fish_offers "$2 $3 $4" ;;
    esac
}

# value NAME COMMAND OPTION WORD EXPECTED...: every shell offers these, and bash nothing else
value() {
    name=$1 command=$2 option=$3 word=$4
    shift 4
    for shell in bash zsh fish; do
        command -v $shell >/dev/null || continue
        cut=
        [ $shell != bash ] || cut=$(printf '%s' "$word" | sed 's/[^:=]*$//')
        for expected; do printf '%s\n' "${expected#"$cut"}"; done >"$work/expected"
        offers $shell "$command" "$option" "$word" >"$work/offered"
        told "$shell: $name"
        [ $shell = bash ] || continue
        n=$((n + 1))
        if [ "$(sort "$work/offered")" = "$(sort "$work/expected")" ]; then
            echo "ok $n - bash: $name, and no other"
        else
            failed=1
            echo "not ok $n - bash: $name, and no other"
        fi
    done
}

methods=$("$program" integrators | sed -n 's/^\([a-z][a-z0-9-]*\) .*/\1/p')
options=$("$program" integrators newmark | sed -n '/^option/,$s/^\([a-z_]\{1,\}\)  .*/newmark:\1=/p' |
    grep -v option=)
value "methods" run -i "" $methods
value "the second method" compare -i rk4,tr rk4,tr-bdf2
value "options of a method" run -i newmark: $options
value "a choice of an option" run -i newmark:variant=h newmark:variant=hht
value "another option, or the next method" compare --integrators rk4:dt=1e-3,d \
    rk4:dt=1e-3,dt= $(echo "$methods" | grep '^d' | sed 's/^/rk4:dt=1e-3,/')
value "renderers" run --renderer "" auto cpu osmesa
value "norms" compare --error-norm "" error path largest velocity energy
"$program" --complete compare --integrator tr >"$work/offered"
echo tr-bdf2 >"$work/expected"
told "methods by the singular of their option"
value "axes" stability --axis "" stiffness damping mass resolution young
value "formats" run --export obj,p obj,pc2
value "checks" conform --only "" $("$program" conform --list | sed 's/ .*//')
value "columns" plot --x ev evals
value "the beginning of a path" run --set bo 'bodies[0].'
value "springs of a body" run -s 'bodies[0].springs.st' 'bodies[0].springs.stretch=' \
    'bodies[0].springs.stiffness_unit='
value "looks" run --set render.look=l render.look=lit
value "a method of the scene" run -s integrator.name=veloc integrator.name=velocity-verlet
echo "1..$n"
exit $failed
