#!/bin/sh
# A study as a Slurm job array: every task does its share of the cells, and a last job joins them.
#
#   ./slurm.sh 100 sweep scene.json -s forces.drag=0,0.01,0.02 -i rk4 -i bdf2 -n 300
#   ./slurm.sh 20 compare scene.json
#
# takes 100 (or 20) tasks, and leaves the table, or the whole report, in whole/ of the folder where it
# was called, which all nodes are to see. Options of sbatch go into SBATCH_PARTITION, SBATCH_TIMELIMIT
# and so on (man sbatch); MEMORY is that of a task (default 2G). A task that fails cancels no other:
# the last job computes what is missing. The same line goes on with the rows that are there; some of
# the tasks alone are run again by SHARES=3,7. There are no more tasks than MaxArraySize allows.
# Processor times are of the nodes they were taken on: rows of different machines are told apart, and
# --exclusive (SBATCH_EXCLUSIVE=user) keeps other jobs from disturbing them.
set -eu
clothsim=${CLOTHSIM:-clothsim}

if [ -n "${SLURM_ARRAY_TASK_ID:-}" ]; then
    shares=$1
    shift
    exec "$clothsim" "$@" --shard "$SLURM_ARRAY_TASK_ID/$shares" \
        --out "part$SLURM_ARRAY_TASK_ID" --quiet
elif [ "${SLURM_JOB_NAME:-}" = clothsim-whole ]; then
    shift
    "$clothsim" merge part*/ --out whole
    exec "$clothsim" "$@" --out whole
fi

shares=$1
shift
most=$(scontrol show config 2>/dev/null | sed -n 's/^MaxArraySize *= *//p')
[ "$shares" -lt "${most:-1001}" ] || shares=$((${most:-1001} - 1))
id=$(sbatch --parsable --job-name=clothsim --array="${SHARES:-1-$shares}" --cpus-per-task=1 \
    --mem-per-cpu="${MEMORY:-2G}" --requeue --output=part%a.log "$0" "$shares" "$@")
exec sbatch --job-name=clothsim-whole --dependency="afterany:${id%%;*}" \
    --mem-per-cpu="${MEMORY:-2G}" --output=whole.log --wait "$0" "$shares" "$@"
