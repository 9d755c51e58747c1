#!/bin/sh
# Files stay near 200 lines: one past 400 has a second job. The model of the law can be read at once:
# at most 250 lines without blank ones, comments and docstrings.
cd "$1" || exit 1
wc -l $(find src tools tests -name "*.[ch]") plugins/*.[ch] include/clothsim/*.h | awk '
    $2 != "total" { n++; if ($1 > 400) { print $2 " has " $1 " lines, expected at most 400"; bad++ } }
    END { print n - bad " passed, " bad + 0 " failed"; exit bad > 0 || n < 50 }' || exit 1
awk '/^ *"""/ { if (!/""".*"""/) inside = !inside; next }
    !inside && !/^ *(#|$)/ { n++ }
    END { print n " lines in tests/model/model.py and surfaces.py, expected at most 250"; exit n > 250 || n < 100 }' \
    tests/model/model.py tests/model/surfaces.py
