#!/bin/sh
# documents.sh PROGRAM SOURCE [all] - the commands of README and tutorial, in their order (as TAP): bash
# and zsh read the same words in each, and those that end soon run. With "all" every one runs, in
# both shells, in a fresh clone with what that has built and installed.
#
# A block between ``` lines is a script of the shell; text with brackets, as in --set, is quoted.
set -eu
export LC_ALL=C

program=$(realpath "$1") source=$(realpath "$2") all=${3:-}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 1' INT TERM

n=0 failed=0
told() { # NAME CODE: a line of the test, with the file "log" where it failed
    n=$((n + 1))
    if [ "$2" -eq 0 ]; then echo "ok $n - $1"; else
        failed=1
        echo "not ok $n - $1"
        sed 's/^/#   /' "$work/log"
    fi
}

# blocks that name a language, as those of a report, are no scripts
script_of() { awk '/^```/ { open = !open; inside = open && $0 == "```"; next } inside' "$1"; }

# films need a program that is no part of this
mkdir "$work/bin" "$work/said"
if ! command -v ffmpeg >/dev/null; then
    printf '#!/bin/sh\nfor last; do :; done\necho film >"$last"\n' >"$work/bin/ffmpeg"
    chmod +x "$work/bin/ffmpeg"
fi

# what a shell makes of the lines: each command prints its words instead of running
for name in clothsim ffmpeg meson; do
    printf '#!/bin/sh\nprintf "<%%s>" %s "$@"\necho\n' $name >"$work/said/$name"
    chmod +x "$work/said/$name"
done
for document in README.md docs/tutorial.md; do
    script_of "$source/$document" >"$work/script"
    grep -q '^clothsim run' "$work/script" || { echo "no commands in $document" >&2; exit 1; }
    for shell in bash zsh; do
        command -v $shell >/dev/null || continue
        mkdir "$work/here"
        # without configuration, but with the way that an interactive zsh reads a remark
        case $shell in zsh) options="-f -o interactivecomments" ;; *) options=--norc ;; esac
        # shellcheck disable=SC2086
        (cd "$work/here" && mkdir dir && printf '#!/bin/sh\n' >dev && chmod +x dev &&
            PATH=$work/said:$PATH $shell $options "$work/script") >"$work/$shell" 2>"$work/log" ||
            echo "$shell fails" >>"$work/$shell"
        rm -r "$work/here"
        cp "$work/$shell" "$work/log"
        code=0
        if [ -s "$work/log" ]; then cmp -s "$work/bash" "$work/$shell" || code=1; else code=1; fi
        told "$document: words of $shell" $code
    done
done

# the number of methods, where no library that some of them need is missing
if "$program" integrators cvode-bdf >"$work/log" 2>&1 && "$program" integrators fast-mass-spring >>"$work/log" 2>&1; then
    methods=$("$program" integrators | grep -c '^[a-z]')
    echo "$methods methods are listed" >"$work/log"
    code=0
    grep -q "[^0-9]$methods integrators as plugins" "$source/README.md" || code=1
    told "README.md: number of integrators" $code
fi

# what takes long, and golden tables, which have a test, are left out of the short one
run() { # SHELL DOCUMENT FILTER
    script_of "$source/$2" | sed "$3" >"$work/script"
    code=0
    $1 -e "$work/script" >"$work/log" 2>&1 </dev/null || code=$?
    told "$2 in $1" $code
}

if [ -z "$all" ]; then
    ln -s "$program" "$work/bin/clothsim"
    PATH=$work/bin:$PATH
    for document in README.md docs/tutorial.md; do
        mkdir "$work/here"
        cd "$work/here"
        ln -s "$source/scenes" "$source/golden" .
        run bash $document '/^\.\/dev/d; /^meson/d; /^clothsim compare/d; /^clothsim stability/d; /^clothsim golden/d'
        cd "$work"
        rm -r here
    done
elif [ -d "$source/.git" ]; then
    for shell in bash zsh; do
        command -v $shell >/dev/null || continue
        git clone -q "$source" "$work/clone"
        mkdir "$work/empty" "$work/root"
        cd "$work/clone"
        # nothing is installed but into a folder of the test
        DESTDIR=$work/root
        export DESTDIR
        PATH=$(dirname "$DESTDIR/usr/local/bin/clothsim"):$work/bin:$PATH
        run $shell README.md '/^\.\/dev test/d'
        cd "$work/empty"
        run $shell README.md '/^\.\/dev/d; /^meson/d'
        run $shell docs/tutorial.md ''
        cd "$work"
        rm -rf clone empty root
    done
fi
echo "1..$n"
exit $failed
