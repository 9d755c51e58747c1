#!/bin/sh
# fuzz.sh BUILD HOURS [TARGET ...] - runs libFuzzer on the targets of a build, or on those named, as
# many at once as there are processors and each for its share of the hours, and adds a line a target
# to tests/fuzz/executions.tsv. What is found stays in BUILD/found, what reaches new places in
# BUILD/corpus, from where the next run goes on.
set -eu
build=$(realpath "$1") hours=$2
cd "$(dirname "$0")"
shift 2
[ $# -gt 0 ] || set -- $(ls fuzz_*.c | sed 's/fuzz_\(.*\)[.]c/\1/')
mkdir -p "$build/found" "$build/corpus"

# words of scenes, from the schema, and of the command line, from the help
{
    grep -oE '"[A-Za-z_][A-Za-z0-9_/ -]{0,30}"' "$build/scene.schema.json" |
        sed 's/"\(.*\)"/"\\"\1\\""/'
    for command in $("$build/clothsim" help | sed -n 's/^  \([a-z-]*\) .*/\1/p'); do
        "$build/clothsim" help "$command" | grep -oE -- '--[a-z-]+' | sed 's/.*/"&"/'
    done
} | sort -u >"$build/dictionary"

processors=$(nproc)
[ "$processors" -le $# ] || processors=$#
seconds=$(awk "BEGIN { print int($hours * 3600 * $processors / $#) }")
commit=$(git rev-parse --short=7 HEAD 2>/dev/null || echo unknown)
export build seconds commit
printf '%s\n' "$@" | xargs -P "$processors" -I TARGET sh -c '
    python3 corpus.py unpack corpus/TARGET.hex "$build/corpus/TARGET"
    code=0
    "$build/tests/fuzz/fuzz_TARGET" -max_total_time="$seconds" -timeout=60 -rss_limit_mb=2048 \
        -max_len=4096 -dict="$build/dictionary" -artifact_prefix="$build/found/TARGET-" \
        -print_final_stats=1 "$build/corpus/TARGET" seeds/TARGET >"$build/TARGET.log" 2>&1 || code=$?
    executions=$(sed -n "s/^stat::number_of_executed_units: //p" "$build/TARGET.log")
    printf "%s\t%s\tTARGET\t%s\t%s\t%s\n" "$(date -u +%F)" "$commit" "${executions:-0}" "$seconds" \
        "$(case $code in 0) echo nothing ;; 70) echo "too slow" ;; 71) echo "too much memory" ;;
            *) echo "crash" ;; esac)" | tee -a executions.tsv
    [ $code = 0 ] || { tail -n 40 "$build/TARGET.log"; exit 1; }'
