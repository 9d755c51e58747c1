#!/bin/sh
# cluster.sh PROGRAM [ENGINE ...] - runs the examples for many machines on the real engines, all on this
# one (as TAP): a Slurm with its own daemons, GNU parallel over an ssh server of its own, Snakemake, and
# processes that are killed. Each leaves the table of one process. Engines: slurm, parallel, snakemake,
# kills; KILLS and CELLS say how many. Needs root, as Slurm's daemons do.
set -eu
CLOTHSIM=$(realpath "$1")
shift
examples=$(cd "$(dirname "$0")/../../examples" && pwd)
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
export CLOTHSIM
daemons=
finish() {
    for pid in $daemons; do
        kill "$pid" 2>/dev/null || :
        wait "$pid" || :
    done
    rm -rf "$work"
}
trap finish EXIT
trap 'exit 1' INT TERM

# daemon LOG COMMAND ... - in the background until the end
daemon() {
    log=$work/$1.log
    shift
    "$@" >"$log" 2>&1 &
    daemons="$! $daemons"
}

# await SECONDS COMMAND ... - until it succeeds
await() {
    left=$(($1 * 5))
    shift
    until "$@" >"$work/await" 2>&1; do
        left=$((left - 1))
        if [ $left -lt 0 ]; then
            echo "# $*: still fails:"
            sed 's/^/# /' "$work/await" "$work"/*.log
            return 1
        fi
        sleep 0.2
    done
}

# a scene with a mesh of its own, and what is done with it
make_study() {
    cat >"$work/scene.json" <<-END
	{"bodies": [{"mesh": {"file": "sheet.obj"}, "mass": {"total": 0.1},
	  "springs": {"stretch": 40, "damping": 0.01}, "pins": [0]}]}
	END
    printf 'v 0 0 0\nv 1 0 0\nv 0 -1 0\nv 1 -1 0.1\nf 1 3 2\nf 2 3 4\n' >"$work/sheet.obj"
    "$CLOTHSIM" sweep "$work/scene.json" $study --out "$work/serial" --quiet
}
study='-s bodies[0].springs.stretch=20,30,40,50,60 -s forces.gravity=[0,-9.81,0],[0,-1,0] -i rk4 -i bdf2:dt=0.005 -n 20'

# report NAME COMMAND ... - a line of the result
report() {
    name=$1
    shift
    n=$((n + 1))
    if "$@"; then
        echo "ok $n - $name"
    else
        echo "not ok $n - $name"
        failed=1
    fi
}

# the table there is that of one process
same() {
    python3 "$here/same.py" "$work/serial/sweep.csv" "$1/sweep.csv"
}

slurm() {
    host=$(hostname -s)
    mkdir "$work/slurm" "$work/state" "$work/spool"
    dd if=/dev/urandom of="$work/munge.key" bs=128 count=1 2>/dev/null
    chmod 0600 "$work/munge.key"
    daemon munged munged --foreground --force --socket="$work/munge.socket" \
        --key-file="$work/munge.key" --pid-file="$work/munge.pid" --log-file="$work/munge.log" \
        --seed-file="$work/munge.seed"
    memory=$(awk '/^MemTotal/ { print int($2 / 1024) }' /proc/meminfo)
    sed -e "s|HOST|$host|" -e "s|WORK|$work|" -e "s|CPUS|$(nproc)|" -e "s|MEGABYTES|$memory|" "$here/slurm.conf.in" \
        >"$work/slurm.conf"
    export SLURM_CONF="$work/slurm.conf"
    await 600 test -S "$work/munge.socket"
    daemon slurmctld slurmctld -D -f "$SLURM_CONF"
    daemon slurmd slurmd -D -f "$SLURM_CONF"
    await 600 sh -c 'sinfo --noheader --format=%t | grep -qx "idle"'
    (cd "$work/slurm" && sh "$examples/slurm.sh" 4 sweep "$work/scene.json" $study) >"$work/out" 2>&1 ||
        sed 's/^/# /' "$work/out"
    report "slurm: a job array of 4 tasks, and the job behind it" same "$work/slurm/whole"
    unset SLURM_CONF
}

over_ssh() {
    mkdir "$work/parallel"
    ssh-keygen -q -t ed25519 -N '' -f "$work/host_key"
    ssh-keygen -q -t ed25519 -N '' -f "$work/user_key"
    port=$((20000 + $$ % 20000))
    mkdir -p /run/sshd
    daemon sshd "$(command -v sshd)" -D -e -f /dev/null -p $port -h "$work/host_key" \
        -o AuthorizedKeysFile="$work/user_key.pub" -o StrictModes=no -o UsePAM=no \
        -o PermitRootLogin=prohibit-password -o ListenAddress=127.0.0.1 -o PidFile=none
    cat >"$work/ssh" <<-END
	#!/bin/sh
	exec ssh -p $port -i "$work/user_key" -o StrictHostKeyChecking=no -o BatchMode=yes \
	    -o UserKnownHostsFile="$work/known" -o LogLevel=ERROR "\$@"
	END
    chmod +x "$work/ssh"
    await 600 "$work/ssh" 127.0.0.1 true
    printf '2/%s/ssh 127.0.0.1\n1/:\n' "$work" >"$work/hosts"
    (cd "$work/parallel" && cp ../scene.json ../sheet.obj . &&
        SEND=sheet.obj sh "$examples/parallel.sh" ../hosts 4 sweep scene.json $study) \
        >"$work/out" 2>&1 || sed 's/^/# /' "$work/out"
    report "parallel: 4 shares on two hosts, one of them behind ssh" same_over_ssh
}

same_over_ssh() {
    grep -q 'Accepted publickey' "$work/sshd.log" && same "$work/parallel/whole"
}

snake() {
    mkdir "$work/snake"
    (cd "$work/snake" && snakemake -s "$examples/Snakefile" --cores 2 --quiet all --config shares=4 \
        clothsim="$CLOTHSIM" study="sweep ../scene.json $study") >"$work/out" 2>&1 ||
        sed 's/^/# /' "$work/out"
    report "snakemake: 4 shares and their whole" same "$work/snake/whole"
}

# 8 processes in one folder, of which one is killed at random, again and again
killed() {
    cells=${CELLS:-400} kills=${KILLS:-20}
    report "$kills kills among 8 processes that do $cells cells: the same table" \
        python3 "$here/kills.py" "$CLOTHSIM" "$work" "$cells" "$kills"
}

n=0 failed=0
[ $# -gt 0 ] || set -- slurm parallel snakemake kills
make_study
echo "1..$#"
for engine; do
    case $engine in
        slurm) slurm ;;
        parallel) over_ssh ;;
        snakemake) snake ;;
        kills) killed ;;
        *) echo "cluster.sh: found engine \"$engine\", expected slurm, parallel, snakemake or kills" >&2 && exit 2 ;;
    esac
done
exit $failed
