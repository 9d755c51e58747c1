#!/bin/sh
# A study as a Slurm job array: every task does its share of the cells, and a last job joins them.
#
#   ./slurm.sh 100 sweep scene.json -s forces.drag=0,0.01,0.02 -i rk4 -i bdf2 -n 300
#   ./slurm.sh 20 compare scene.json
#
# takes 100 (or 20) tasks, and leaves the table, or the whole report, in whole/ of the folder where it
# was called, which all nodes are to see. Options of sbatch go into SBATCH_PARTITION, SBATCH_TIMELIMIT
# and so on (man sbatch). A task that was lost is run again with the same line: rows that are there
# are kept. Processor times are of the nodes they were taken on: rows of different machines are told
# apart, and --exclusive (SBATCH_EXCLUSIVE=user) keeps other jobs from disturbing them.
set -eu
clothsim=${CLOTHSIM:-clothsim}

if [ -n "${SLURM_ARRAY_TASK_ID:-}" ]; then
    exec "$clothsim" "$@" --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT" \
        --out "part$SLURM_ARRAY_TASK_ID" --quiet
elif [ "${SLURM_JOB_NAME:-}" = clothsim-whole ]; then
    "$clothsim" merge part*/ --out whole
    exec "$clothsim" "$@" --out whole
fi

shares=$1
shift
id=$(sbatch --parsable --job-name=clothsim --array="1-$shares" --cpus-per-task=1 --requeue \
    --output=part%a.log "$0" "$@")
exec sbatch --job-name=clothsim-whole --dependency="afterok:${id%%;*}" --kill-on-invalid-dep=yes \
    --output=whole.log --wait "$0" "$@"
