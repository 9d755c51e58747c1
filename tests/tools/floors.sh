#!/bin/sh
# Who may include whom: only what lies on a lower floor, or in the own folder.
#   include -> base -> model -> io | draw | sim -> study -> cli; modules: include only.
cd "$1" || exit 1
awk '
    function floor(folder) {
        return folder == "base" ? 1 : folder == "model" ? 2 \
             : folder ~ /^(io|draw|sim)$/ ? 3 : folder == "study" ? 4 : folder == "cli" ? 5 : 0
    }
    /^#include "/ {
        split($0, quoted, "\""); split(quoted[2], to, "/"); split(FILENAME, from, "/")
        if (from[1] == "plugins") {
            if (quoted[2] ~ /\//) wrong(FILENAME " includes " quoted[2] ": modules see only <clothsim/...>")
        } else if (!floor(to[1])) {
            wrong(FILENAME " includes " quoted[2] ": no folder of src")
        } else if (from[2] != to[1] && floor(from[2]) <= floor(to[1]))
            wrong(FILENAME " includes " quoted[2] ": not on a lower floor")
        count++
    }
    FILENAME ~ /^include/ && /^#include </ && !/<(clothsim\/|std|math)/ {
        wrong(FILENAME ": " $0 ": only the standard library and clothsim")
    }
    function wrong(message) { print message; failures++ }
    END {
        if (count < 100) wrong("only " count + 0 " includes were read")
        print count - failures " passed, " failures + 0 " failed"
        exit failures > 0
    }' src/*/*.[ch] plugins/*.[ch] include/clothsim/*.h
