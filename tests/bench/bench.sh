#!/bin/sh
# bench.sh BENCH REPORT - the sections that need no program of others, on small sizes: each writes a
# file with the columns that it declares, and every figure in it is a number above 0.
set -eu

bench=$1 report=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0

expect() { # expect WHAT FOUND EXPECTED
    [ "$2" = "$3" ] || {
        echo "$1: found \"$2\", expected \"$3\""
        failed=$((failed + 1))
    }
}

# columns SECTION KEYS NAMES ROWS
columns() {
    file=$work/csv/$1.csv
    expect "$1: names" "$(grep -v '^#' "$file" | head -n 1)" "$3"
    expect "$1: keys" "$(sed -n 's/^# keys: //p' "$file")" "$2"
    expect "$1: rows" "$(grep -vc '^#' "$file")" $(($4 + 1))
    for fact in section date version machine compiler threads mode measured; do
        grep -q "^# $fact: ." "$file" || expect "$1" "no \"# $fact\"" "one"
    done
    expect "$1: figures" "$(grep -v '^#' "$file" | awk -F, -v keys="$2" '
        NR > 1 {
            for (c = keys + 1; c <= NF; c++)
                if ($c != "" && $c !~ /^[a-z]+$/ && !($c ~ /^[0-9.e+-]+$/ && $c >= 0))
                    print "line " NR ": " $c
            if (!($(keys + 1) > 0))
                print "line " NR ": " $(keys + 1) " is no time"
        }')" ""
}

"$bench" --quick --csv "$work/csv" limits kernels steps plain thesis pairs contact pictures >"$work/tables" 2>"$work/progress"
columns limits 2 loop,kib,median_ns,min_ns,max_ns,gb_a_s 5
columns kernels 2 sheet,kernel,median_ns,min_ns,max_ns,spring_ns,limit_ns,bound_by,to_limit 42
columns steps 5 method,sheet,stiffness,h,steps,median_ms,min_ms,max_ms,ns_particle,forces,to_limit,iterations,peak_mib 15
columns plain 1 sheet,plain_ns,median_ns,min_ns,max_ns,ratio 2
columns thesis 3 method,steps,r,total_ms,median_ms,max_ms,forces_ms,integration_ms,contact_ms,limit_ms,normals_ms,times_thesis 16
columns pairs 3 sheet,state,stage,median_ns,min_ns,max_ns,number,each_ns,to_springs 33
columns contact 3 scene,set,frames,steps,median_s,min_s,max_s,ms_a_step 7
columns pictures 4 scene,look,size,by,median_ms,min_ms,max_ms,first_ms 4
expect "sections printed" "$(grep -c '^[a-z]*: ' "$work/tables")" 8

# a section that was not asked for leaves nothing behind
expect "files" "$(ls "$work/csv" | tr '\n' ' ')" "contact.csv kernels.csv limits.csv pairs.csv pictures.csv plain.csv steps.csv thesis.csv "

code=0
"$bench" speed >"$work/out" 2>&1 || code=$?
expect "wrong name: exit code" $code 2
expect "wrong name" "$(cat "$work/out")" 'bench: no section "speed" (see: bench --help)'

# the same results twice: no gain anywhere; half the time: twice as fast
"$report" "$work/csv" "$work/csv" >"$work/same"
expect "gains of the same" "$(grep -c '| (1\.00) |' "$work/same")" 124
mkdir "$work/half"
printf '# keys: 1\n# measured: median_ns\n# date: d\n# version: v\n# machine: m\n# compiler: c\n# threads: 1\n# mode: full\nloop,median_ns,min_ns\nthis,%s\n' \
    8,6 >"$work/half/limits.csv"
mkdir "$work/after"
sed 's/^this.*/this,4,3/' "$work/half/limits.csv" >"$work/after/limits.csv"
expect "gain of half" "$("$report" "$work/half" "$work/after" | grep this)" '| this | 8 | 4 | 2.00 |'

# quick results are of other models than full ones
code=0
"$report" "$work/half" "$work/csv" >"$work/out" 2>&1 || code=$?
expect "quick against full: exit code" $code 1

# a page keeps its words, and its tables are replaced
printf 'words\n<!-- bench limits -->\nold\n<!-- end -->\nmore words\n' >"$work/page.md"
"$report" --page "$work/page.md" "$work/half"
expect "page" "$(grep -c '^words$\|^more words$\|^| this | 8 | 6 |$\|^old$' "$work/page.md")" 3

[ $failed = 0 ] || exit 1
