#!/bin/sh
# A study on every host of a list, by GNU parallel over ssh: no common folder and no scheduler.
#
#   ./parallel.sh hosts 16 sweep scene.json -s forces.drag=0,0.01,0.02 -i rk4 -i bdf2 -n 300
#
# hosts has a line a host, such as "4/node1" for four processes at a time on node1 (man parallel,
# --sshloginfile); ":" is this machine, whose shares are run in this folder. The scene is sent with every share; other files that it names
# (meshes) go into SEND, such as SEND="disc.obj". A share that failed or whose host is lost is done
# again elsewhere, three times at most. The table is in whole/. All hosts need ssh, rsync and the same
# clothsim, whose path is CLOTHSIM.
set -eu
clothsim=${CLOTHSIM:-clothsim}
hosts=$1 shares=$2 scene=$4
shift 2

# parallel copies nothing for ":", and remote jobs do not see the variable
CLOTHSIM_FOLDER=$PWD
export CLOTHSIM_FOLDER

send="--transferfile $scene"
for file in ${SEND:-}; do send="$send --transferfile $file"; done
seq "$shares" | parallel --sshloginfile "$hosts" --workdir ... $send --return part{} --cleanup \
    --retries 3 --quote sh -c 'cd "${CLOTHSIM_FOLDER:-.}" && exec "$@"' sh \
    "$clothsim" "$@" --shard "{}/$shares" --out "part{}" --quiet
"$clothsim" merge part*/ --out whole
exec "$clothsim" "$@" --out whole
