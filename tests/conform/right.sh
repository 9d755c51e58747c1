#!/bin/sh
# SPDX-License-Identifier: MIT
# right.sh PROGRAM MODULE ... - right modules of kinds that are not shipped pass the card (as TAP).
set -u
program=$1
shift
n=0 failed=0
for module; do
    n=$((n + 1)) verdict=ok
    found=$("$program" conform -q "$module" 2>&1) || verdict="not ok" failed=1
    case $found in *" pass, 0 fail, 0 expected"*) ;; *) verdict="not ok" failed=1 ;; esac
    echo "$verdict $n - $(basename "$module" .so)"
    [ "$verdict" = ok ] || echo "$found" | sed 's/^/#   /'
done
[ "$n" -gt 0 ] || failed=1
echo "1..$n"
exit $failed
