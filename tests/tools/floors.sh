#!/bin/sh
# Who may include whom: the own folder, and folders on lower floors; modules: include only.
# A folder of src that is not in the list below is an error, and so is one with more than 25
# units (a unit: NAME.c, NAME.h or both). The host is known to sim alone, and only a session begins
# a run.
cd "$1" || exit 1
awk '
    BEGIN {
        n = split("base mesh scene model/spring model/system model/contact model/force" \
            " model/commit,model/solver,model/event model io,draw,sim draw/gl,draw/cpu study" \
            " study/compare,study/stability,study/conform,study/golden,study/soft cli", floors, " ")
        for (i = 1; i <= n; i++) {
            count_of = split(floors[i], folders, ",")
            for (k = 1; k <= count_of; k++) floor[folders[k]] = i
        }
    }
    function folder_of(path) { sub(/\/[^\/]*$/, "", path); return path }
    FNR == 1 && FILENAME ~ /^src/ {
        from = folder_of(substr(FILENAME, 5)); unit = FILENAME; sub(/\.[ch]$/, "", unit)
        if (!(from in floor)) wrong(FILENAME ": the floor of src/" from " is not known")
        if (!(unit in units)) { units[unit]; if (++inside[from] == 26) wrong("src/" from " has more than 25 units") }
    }
    /^#include "/ {
        split($0, quoted, "\"")
        if (FILENAME ~ /^plugins/) {
            if (quoted[2] ~ /\//) wrong(FILENAME " includes " quoted[2] ": modules see only <clothsim/...>")
        } else {
            to = folder_of(quoted[2])
            if (!(to in floor)) wrong(FILENAME " includes " quoted[2] ": no folder of src")
            else if (from != to && floor[from] <= floor[to])
                wrong(FILENAME " includes " quoted[2] ": not on a lower floor")
        }
        if (quoted[2] == "sim/host.h" && from != "sim") wrong(FILENAME " includes sim/host.h: see the doors in sim/run.h")
        count++
    }
    /cs_run_begin\(/ && from != "sim" && FILENAME != "src/study/session.c" {
        wrong(FILENAME " begins a run: see cs_session_begin")
    }
    FILENAME ~ /^include/ && /^#include </ && !/<(clothsim\/|std|math)/ {
        wrong(FILENAME ": " $0 ": only the standard library and clothsim")
    }
    function wrong(message) { print message; failures++ }
    END {
        if (count < 100) wrong("only " count + 0 " includes were read")
        print count - failures " passed, " failures + 0 " failed"
        exit failures > 0
    }' $(find src -name '*.[ch]') plugins/*.[ch] include/clothsim/*.h
