#!/bin/sh
# Files stay near 200 lines: one past 400 has a second job.
cd "$1" || exit 1
wc -l $(find src -name "*.[ch]") plugins/*.[ch] include/clothsim/*.h | awk '
    $2 != "total" { n++; if ($1 > 400) { print $2 " has " $1 " lines, expected at most 400"; bad++ } }
    END { print n - bad " passed, " bad + 0 " failed"; exit bad > 0 || n < 50 }'
