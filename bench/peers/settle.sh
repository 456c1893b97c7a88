#!/bin/sh
# Does scree arrive at the same beds and flows as other programs? Spheres that begin a little elsewhere (another seed of the
# lattice's jitter) end elsewhere; what all share, and how far it scatters from start to start, is printed for each program:
# mean and standard deviation of each quantity of `scree-bench look`, and by how many standard errors of the difference the mean is off
# scree's.
usage='usage: settle.sh BUILD SCENE [STARTS [STEPS [PROGRAM...]]]

BUILD   a build folder of scree
SCENE   bed (10,000 spheres fall and settle: 3000, 10,000 and 30,000 steps by default), chute (31,200 flow, from a settled
        state, its places shifted by 1e-6 of a diameter at random: 10,000 steps)
STARTS  how many (default 4)
STEPS   after which to look; several in quotes: the whole run to each of them
PROGRAM which run (default: scree lammps liggghts)

example: bench/peers/settle.sh build bed 4'
[ $# -ge 2 ] || { echo "$usage" >&2; exit 2; }
complain() { echo "settle.sh: $*" >&2; exit 2; }
[ -x "$1/bench/scree-bench" ] || complain "there is no $1/bench/scree-bench"
build=$(realpath "$1") scene=$2 starts=${3:-4}
here=$(realpath "$(dirname "$0")")
case $scene in
bed) steps=${4:-3000 10000 30000} ;;
chute)
    steps=${4:-10000}
    [ -s "$build/peers/chute/start.csv" ] || complain "there is no settled chute: peers.sh $1 chute 1 1 - scree makes one"
    ;;
*) echo "$usage" >&2; exit 2 ;;
esac
programs='scree lammps liggghts'
[ $# -gt 4 ] && programs=$(shift 4 && echo "$*")
case $starts in 0* | *[!0-9]*) complain "STARTS is a whole number from 1 on, not \"$starts\"" ;; esac
work=$build/peers/settle_$scene
mkdir -p "$work" || exit 1

start_of() { # start_of N: a table of spheres
    if [ "$scene" = chute ]; then
        awk -v seed="$1" -F, 'BEGIN { OFS = ","; srand(seed) }
            NR == 1 { for (k = 1; k <= NF; k++) if ($k == "x_m") x = k }
            NR > 1 { for (k = x; k < x + 3; k++) $k = sprintf("%.17g", $k + 1e-6 * (rand() - 0.5)) } { print }' "$build/peers/chute/start.csv"
        return
    fi
    sed '/^# The spheres that move/,$d' "$here/bed.toml" >"$work/lattice.toml"
    printf '[[generate]]\nname = "grain"\nkind = "lattice"\nmaterial = "glass"\nseed = %s\ncount = 10000\nmin = [0, 0, 0]\nmax = [0.04, 0.04, 0.5]\nspacing = 0.0022\njitter = 8e-5\nradius = 0.001\n' "$1" >>"$work/lattice.toml"
    "$build/scree" run "$work/lattice.toml" -o "$work/lattice" --set body.right.position=[0.04,0,0] --set body.back.position=[0,0.04,0] --set time.end=1e-5 >/dev/null 2>&1 || exit 1
    cat "$work/lattice/spheres.csv"
}

rm -f "$work/rows.csv"
for n in $(seq "$starts"); do
    start_of "$n" >"$work/start.csv"
    for many in $steps; do
        # shellcheck disable=SC2086
        rows=$("$here/peers.sh" "$build" "$scene" 1 "$many" "$work/start.csv" $programs) || exit 1
        echo "$rows" | sed 1d | tee -a "$work/rows.csv" >&2
    done
done
grep -m 1 'model name' /proc/cpuinfo | sed 's/.*: /# /'
awk -F, 'FNR == 1 { columns = NF; for (k = 8; k <= NF; k++) name[k] = $k }
    $1 != "scene" {
        if (!(($3, $2) in runs)) { order[++rows] = $2; at[rows] = $3 }
        runs[$3, $2]++
        for (k = 8; k <= NF; k++) { sum[$3, $2, k] += $k; square[$3, $2, k] += $k * $k }
    }
    function mean(r, p, k) { return sum[r, p, k] / runs[r, p] }
    function variance(r, p, k, n, v) {
        n = runs[r, p]
        v = square[r, p, k] / n - mean(r, p, k) ^ 2
        return (n > 1 && v > 0) ? v * n / (n - 1) : 0
    }
    END {
        print "steps,program,starts,quantity,mean,deviation,off_scree_in_standard_errors"
        for (p = 1; p <= rows; p++)
            for (k = 8; k <= columns; k++) {
                r = at[p]
                error = sqrt((variance(r, order[p], k) + variance(r, "scree", k)) / runs[r, order[p]])
                off = error > 0 ? (mean(r, order[p], k) - mean(r, "scree", k)) / error : 0
                printf "%d,%s,%d,%s,%.7g,%.2g,%.1f\n", r, order[p], runs[r, order[p]], name[k], mean(r, order[p], k), sqrt(variance(r, order[p], k)), off
            }
    }' "$work/rows.csv"
