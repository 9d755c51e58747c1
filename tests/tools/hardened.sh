#!/bin/sh
# hardened.sh "CC ..." "PROPERTY ..." FILE ... - what the build was hardened with is in every program
# and module, and in what is built without it is not (as TAP).
set -u
cc=$1 properties=$2
shift 2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
n=0 failed=0
LC_ALL=C
export LC_ALL

# has PROPERTY FILE: whether the file shows it
has() {
    case $1 in
        pie) readelf -hW "$2" | grep -q 'Type: *DYN' ;;
        tables) # those of functions are filled in at the start, and no stack runs as a program
            readelf -lW "$2" | grep -q GNU_RELRO && readelf -dW "$2" | grep -qE 'BIND_NOW|Flags:.* NOW' &&
                readelf -lW "$2" | grep -qE 'GNU_STACK.* RW ' ;;
        protector) readelf -sW "$2" | grep -q __stack_chk_fail ;;
        calls) readelf -sW "$2" | grep -qE '__[a-z]+_chk(@|$)' ;;
        # endbr64 or endbr32 where calls may land; start files have a few of their own
        branches) [ "$(grep -aoP '\xf3\x0f\x1e[\xfa\xfb]' "$2" | wc -l)" -gt 50 ] ;;
    esac
}

expect() {
    n=$((n + 1))
    if [ "$1" -eq 0 ]; then echo "ok $n - $2"; else
        echo "not ok $n - $2"
        failed=1
    fi
}

# a module of few calls may have none that is checked, or no array to protect: the program has
program=$1
for property in $properties; do
    case $property in
        pie | tables) files=$* ;;
        protector | calls | branches) files=$program ;;
        *) continue ;; # stack probes are in large frames only
    esac
    for file in $files; do
        has "$property" "$file"
        expect $? "$property: ${file##*/}"
    done
done

cat >"$work/plain.c" <<'C'
#include <string.h>
int main(int argc, char **argv) {
    char text[64];
    strcpy(text, argv[argc - 1]);
    return text[0];
}
C
if $cc -O2 -fno-pie -no-pie -fno-stack-protector -U_FORTIFY_SOURCE -Wl,-z,norelro -Wl,-z,lazy \
    -o "$work/plain" "$work/plain.c"; then
    for property in pie tables protector calls branches; do
        ! has $property "$work/plain"
        expect $? "$property: not in what is built without"
    done
fi
echo "1..$n"
exit $failed
