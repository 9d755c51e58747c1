#!/bin/sh
# Who may include whom: the own folder, and folders on lower floors; modules: include only. The
# folders of tools stand above all of src.
# A folder of src that is not in the list below is an error, and so is one with more than 25
# units (a unit: NAME.c, NAME.h or both). Units form no circle either, in src or in plugins: one that
# includes another's header, or names what another's .c defines (a header may declare for several),
# stands above it.
# What opens a file to write it, renames or removes one, is base/file.c, which looks at the target.
# Behind a wall, exports, studies, commands, tools, bench and the tests of these see session in place of
# the rooms below it. The tests of units, of physics and of bytes from outside may look behind it.
# The host is known to sim alone, only a session begins a run, and only session_calls.c steps one.
cd "$1" || exit 1
outside=$(ls -d bench tests/abi tests/bench tests/cli tests/compare tests/conform tests/faults tests/golden tests/model tests/stability 2>/dev/null)
awk '
    BEGIN {
        n = split("base mesh scene model/spring model/system model/elastic model/force model/contact model/contact/broad_phase" \
            " model/contact/narrow_phase model/contact/ccd model/solver,model/event model/post_step model" \
            " scene/file draw,sim,diagram draw/gl,draw/cpu,diagram/cairo session export study study/reference" \
            " study/compare cli/line cli/show cli cli/run sweep,borders shared advise,bisect,conform,describe,files,film,golden,integrators,new,reproduce,soft,stability", floors, " ")
        for (i = 1; i <= n; i++) {
            count_of = split(floors[i], folders, ",")
            for (k = 1; k <= count_of; k++) floor[folders[k]] = i
        }
    }
    # who sees base, and of all other rooms of src below it session alone, but for these doors
    BEGIN {
        inner = "^(mesh|scene|model|sim|draw)(/|$)"
        split("draw/camera_fit.h draw/glyph.h draw/srgb.h" \
            " model/contact/barrier_law.h scene/file/json.h scene/file/mesh_read.h scene/mesh_keys.h", doors, " ")
        for (i in doors) door[doors[i]]
        measures["bench/kernels.c"] # single forces and products, each by itself
        measures["bench/pairs.c"]   # the passes over contact between surfaces, each by itself
    }
    function folder_of(path) { sub(/\/[^\/]*$/, "", path); return path }
    function unit_of(path) { sub(/^(src|tools)\//, "", path); sub(/\.[ch]$/, "", path); return path }

    # --- who may include whom, and how many there are ---
    FILENAME ~ /^(bench|tests)/ {
        if (/^#include "/ && split($0, quoted, "\"") && folder_of(quoted[2]) ~ inner && !(quoted[2] in door) && !(FILENAME in measures))
            wrong(FILENAME " includes " quoted[2] ": behind the wall, see src/session")
        next
    }
    FNR == 1 { here = unit_of(FILENAME); in_comment = 0 }
    FNR == 1 && FILENAME ~ /^(src|tools)/ {
        from = folder_of(here)
        if (!(from in floor)) wrong(FILENAME ": the floor of " from " is not known")
    }
    FNR == 1 && !(here in known) {
        known[here]; units[++n_units] = here
        if (FILENAME ~ /^(src|tools)/ && ++inside[from] == 26) wrong(from " has more than 25 units")
    }
    /^#include "/ {
        split($0, quoted, "\"")
        if (FILENAME ~ /^plugins/) {
            if (quoted[2] ~ /\//) wrong(FILENAME " includes " quoted[2] ": modules see only <clothsim/...>")
            else connect(here, "plugins/" unit_of(quoted[2]), "includes " quoted[2])
        } else {
            to = folder_of(quoted[2])
            if (!(to in floor)) wrong(FILENAME " includes " quoted[2] ": no folder of src")
            else if (from != to && floor[from] <= floor[to])
                wrong(FILENAME " includes " quoted[2] ": not on a lower floor")
            connect(here, unit_of(quoted[2]), "includes " quoted[2])
        }
        if (quoted[2] ~ /^sim\/(run_)?host.h$/ && from != "sim") wrong(FILENAME " includes sim/host.h: see the doors in sim/run_state.h")
        if ((FILENAME ~ /^tools/ || from ~ /^(export|study|cli)(\/|$)/) && to ~ inner && !(quoted[2] in door)) {
            wrong(FILENAME " includes " quoted[2] ": behind the wall, see src/session")
        }
        count++
    }
    /cs_run_begin\(/ && from != "sim" && FILENAME != "src/session/session.c" {
        wrong(FILENAME " begins a run: see cs_session_begin")
    }
    /cs_run_frame\(/ && FILENAME ~ /^(src|tools)/ && from != "sim" && FILENAME != "src/session/session_calls.c" {
        wrong(FILENAME " steps a run: see cs_follow_next")
    }
    FILENAME ~ /^include/ && /^#include </ && !/<(clothsim\/|std|math)/ {
        wrong(FILENAME ": " $0 ": only the standard library and clothsim")
    }

    # --- circles: what each .c defines and names, without comments and texts; what plugins share
    # with each other has no prefix ---
    FNR == 1 { shared = FILENAME ~ /^plugins/ ? "[a-z][a-z0-9_]+" : "cs_[a-z0-9_]+" }
    FILENAME !~ /^(src|tools|plugins).*\.c$/ { next }
    {
        line = $0
        gsub(/"([^"\\]|\\.)*"/, "", line); sub(/\/\/.*/, "", line)
        if (in_comment && !sub(/^.*\*\//, "", line)) next
        gsub(/\/\*([^*]|\*[^\/])*\*\//, "", line)
        in_comment = sub(/\/\*.*/, "", line)
    }
    # what studies and commands read of a system, until it is opaque to them
    from ~ /^(export|study|cli)/ {
        read = line
        gsub(/system(->|\.)(inv_mass|mass|plan|scene|state|view)([^a-z_]|$)/, "", read)
        if (match(read, /system(->|\.)[a-z_]+/)) wrong(FILENAME ":" FNR ": reads " substr(read, RSTART, RLENGTH) ": see src/session")
    }
    # a path that is a text is one of /dev or /proc
    here != "base/file" && (line ~ /(^|[^a-z_.>])(rename|unlink|remove|mkdir|creat|mkstemp|truncate)(at)?\(/ ||
                            line ~ /(^|[^a-z_])open(at)?\([^,]+,.*O_(CREAT|WRONLY|RDWR)/ || $0 ~ /fopen\([^"]*, "(w|a|r\+)/) {
        wrong(FILENAME ":" FNR ": writes, renames or removes a file: see base/file.h")
    }
    line ~ /^[a-z]/ && line !~ /^(static|extern|typedef)/ && match(line, shared "(\\(|\\[| =)") {
        name = substr(line, RSTART, RLENGTH); sub(/[^a-z0-9_].*/, "", name)
        if (index(owners[name] " ", " " here " ") == 0) owners[name] = owners[name] " " here
    }
    {
        while (match(line, shared)) {
            name = substr(line, RSTART, RLENGTH); line = substr(line, RSTART + RLENGTH)
            if (!((here, name) in named)) { named[here, name]; names[here] = names[here] " " name }
        }
    }
    function connect(from, to, why) {
        if (from == to || (from, to) in reason) return
        reason[from, to] = why; below[from] = below[from] " " to
    }
    function connect_names(unit,    n, list, k, m, homes, i) {
        n = split(names[unit], list, " ")
        for (k = 1; k <= n; k++) {
            if (!(list[k] in owners) || index(owners[list[k]] " ", " " unit " ")) continue
            m = split(owners[list[k]], homes, " ")
            for (i = 1; i <= m; i++) connect(unit, homes[i], "names " list[k] " of " homes[i])
        }
    }
    # depth first; way[1..depth]: the units from the first to this one
    function visit(unit, depth,    n, list, k) {
        state[unit] = "open"; way[depth] = unit
        n = split(below[unit], list, " ")
        for (k = 1; k <= n; k++)
            if (!(list[k] in state)) visit(list[k], depth + 1)
            else if (state[list[k]] == "open") tell_circle(list[k], depth)
        state[unit] = "done"
    }
    function tell_circle(first, depth,    message, k) {
        for (k = depth; way[k] != first; k--) continue
        for (; k < depth; k++) message = message way[k] " " reason[way[k], way[k + 1]] ", "
        wrong("circle: " message way[depth] " " reason[way[depth], first])
    }

    function wrong(message) { print message; failures++ }
    END {
        if (count < 100) wrong("only " count + 0 " includes were read")
        for (k = 1; k <= n_units; k++) connect_names(units[k])
        for (k = 1; k <= n_units; k++) if (!(units[k] in state)) visit(units[k], 1)
        count += n_units
        print count - failures " passed, " failures + 0 " failed"
        exit failures > 0
    }' $(find src tools $outside -name '*.[ch]' | LC_ALL=C sort) plugins/*.[ch] include/clothsim/*.h
