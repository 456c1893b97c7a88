#!/bin/sh
# Scenes of many spheres, run in turn by scree and by whatever else is installed, all from the same positions and velocities, one
# thread each; nanoseconds per sphere and step, and what the states are like afterwards. All run on one processor, the first
# that this shell may use: others of a virtual machine may be shared with somebody, and half as fast.
usage='usage: peers.sh BUILD SCENE [ROUNDS [STEPS [STATE [PROGRAM...]]]]

BUILD   a build folder of scree
SCENE   bed (10,000 spheres), bed-large (100,000), chute (31,200 on a frozen base of 800)
ROUNDS  how often each program runs (default 5)
STEPS   in each run (default 200)
STATE   spheres.csv to begin with; default, or -: what scree settles (kept in BUILD/peers, which takes long the first time)
PROGRAM scree, lammps, liggghts, yade: which run (default: all that are installed)

example: bench/peers/peers.sh build bed 5 200'
[ $# -ge 2 ] || { echo "$usage" >&2; exit 2; }
[ -x "$1/bench/scree-bench" ] || { echo "peers.sh: there is no $1/bench/scree-bench" >&2; exit 2; }
build=$(realpath "$1") scene=$2 rounds=${3:-5} steps=${4:-200} programs=scree
[ $# -gt 5 ] && programs=$(shift 5 && echo "$*")
complain() { echo "peers.sh: $*" >&2; exit 2; }
for number in "$rounds" "$steps"; do
    case $number in 0* | *[!0-9]*) complain "ROUNDS and STEPS are whole numbers from 1 on, not \"$number\"" ;; esac
done
for program in $programs; do
    case $program in
    scree) ;;
    lammps | liggghts | yade)
        command -v "$(echo $program | sed s/lammps/lmp/)" >/dev/null || complain "$program isn't installed"
        [ $program != yade ] || [ "$2" != chute ] || complain 'there is no chute for yade'
        ;;
    *) complain "there is no program \"$program\" (scree, lammps, liggghts, yade)" ;;
    esac
done
start=start.csv
[ "${5:--}" = - ] || { [ -s "$5" ] && start=$(realpath "$5"); } || complain "there is no state $5"
here=$(realpath "$(dirname "$0")")
scree=$build/scree look=$build/bench/scree-bench
export OMP_NUM_THREADS=1 LC_ALL=C
pin=
command -v taskset >/dev/null && pin="taskset -c $(taskset -cp $$ | sed 's/.*: //; s/[-,].*//')"
case $scene in
bed) kind=bed count=10000 length=0.04 time=0.3 ;;
bed-large) kind=bed count=100000 length=0.16 time=0.25 ;;
chute) kind=chute count=31200 length=40 time=10 ;;
*) echo "$usage" >&2; exit 2 ;;
esac
work=$build/peers/$scene
mkdir -p "$work" || exit 1
cd "$work" || exit 1
cp "$here/$kind.toml" .

# The sizes of a scene: --set options.
sizes() {
    [ $kind = bed ] || return 0
    echo "--set body.right.position=[$length,0,0] --set body.back.position=[0,$length,0]"
}

# Let them fall from a lattice, once.
settle() {
    case $kind in
    bed) lattice="min = [0, 0, 0]\nmax = [$length, $length, 0.5]\nspacing = 0.0022\njitter = 8e-5\nradius = 0.001" ;;
    chute) lattice="min = [0, 0, 1.5]\nmax = [40, 20, 60]\nspacing = 1.11\njitter = 0.05\nradius = 0.5" ;;
    esac
    sed '/^# The spheres that move/,$d' $kind.toml >settle.toml
    printf "[[generate]]\nname = \"grain\"\nkind = \"lattice\"\nmaterial = \"glass\"\nseed = 7\ncount = $count\n$lattice\n" >>settle.toml
    # shellcheck disable=SC2046
    "$scree" run settle.toml -o settled $(sizes) --set "time.end=$time" || exit 1
    cp settled/spheres.csv start.csv
}

# A layer of frozen spheres, moved up and down by up to a quarter of their diameter.
make_base() {
    awk 'BEGIN {
        print "x_m,y_m,z_m,radius_m"
        for (k = 0; k < 800; k++) {
            seed = (seed * 16807 + 12345) % 2147483647
            printf "%.1f,%.1f,%.17g,0.5\n", k % 40 + 0.5, int(k / 40) + 0.5, 0.5 + 0.5 * (seed / 2147483647 - 0.5)
        }
    }' >base.csv
}

[ $kind = chute ] && make_base
[ -s "$start" ] || settle
# Just the numbers: position, radius, velocity, spin.
awk -F, 'NR == 1 { for (k = 1; k <= NF; k++) if ($k == "x_m") first = k }
    { line = $first; for (k = first + 1; k < first + 10; k++) line = line "," $k; print line }' "$start" >spheres.csv
spheres=$(($(wc -l <spheres.csv) - 1))
case $kind in
bed) awk -v density=2500 -v low="0 0 0" -v high="$length $length 0.5" -f "$here/to_data.awk" spheres.csv >spheres.data ;;
chute)
    sed 's/$/,0,0,0,0,0,0/' base.csv >base_still.csv
    awk -v density=1.9098593171027440 -v low="0 0 -1" -v high="40 20 100" -f "$here/to_data.awk" spheres.csv base_still.csv >spheres.data
    ;;
esac

# Seconds that PROGRAM takes for the steps; its final state in final_PROGRAM.csv.
seconds_of() {
    case $1 in
    scree)
        step=$(sed -n 's/^step = //p' $kind.toml)
        # shellcheck disable=SC2046
        $pin "$scree" run $kind.toml -o scree_run $(sizes) --set "time.end=$(awk "BEGIN { printf \"%.17g\", $step * $steps }")" 2>scree.log
        sed 's/^[^,]*,//; s/,[^,]*$//' scree_run/spheres.csv >final_scree.csv
        sed -n 's/^[0-9]* steps of .* in \(.*\) s (.*/\1/p' scree.log
        ;;
    lammps)
        $pin lmp -in "$here/$kind.lammps" -sf none -log none -var data spheres.data -var length $length -var steps "$steps" -var out lammps.dump >lammps.log 2>&1
        awk -f "$here/from_dump.awk" lammps.dump >final_lammps.csv
        sed -n 's/^Loop time of \([^ ]*\) .*/\1/p' lammps.log | head -n 1
        ;;
    liggghts)
        $pin liggghts -in "$here/$kind.liggghts" -log none -var data spheres.data -var length $length -var steps "$steps" -var out liggghts.dump >liggghts.log 2>&1
        awk -f "$here/from_dump.awk" liggghts.dump >final_liggghts.csv
        sed -n 's/^Loop time of \([^ ]*\) .*/\1/p' liggghts.log | head -n 1
        ;;
    yade)
        SPHERES=spheres.csv LENGTH=$length STEPS=$steps OUT=final_yade.csv $pin yade -x -n -j1 "$here/${kind}_yade.py" >yade.log 2>&1
        sed -n 's/^Loop time of //p' yade.log
        ;;
    esac
}

if [ $# -le 5 ]; then
    command -v lmp >/dev/null && programs="$programs lammps"
    command -v liggghts >/dev/null && programs="$programs liggghts"
    command -v yade >/dev/null && [ -e "$here/${kind}_yade.py" ] && programs="$programs yade"
fi
rm -f times.csv final_*.csv
for round in $(seq "$rounds"); do
    for program in $programs; do
        seconds=$(seconds_of $program)
        [ -n "$seconds" ] || { echo "peers.sh: $program failed: see $work/$program.log" >&2; rm -f final_$program.csv; continue; }
        echo "$round,$program,$seconds" >>times.csv
        echo "round $round: $program $(awk "BEGIN { printf \"%.1f\", $seconds / $spheres / $steps * 1e9 }") ns per sphere and step" >&2
    done
done

median() { sort -g | awk '{ v[NR] = $1 } END { printf "%.4g", NR % 2 ? v[(NR + 1) / 2] : (v[NR / 2] + v[NR / 2 + 1]) / 2 }'; }
grep -m 1 'model name' /proc/cpuinfo | sed 's/.*: /# /'
# shellcheck disable=SC2046
echo "scene,program,steps,rounds,ns_per_sphere_step,times_scree,$("$look" look $kind.toml $(sizes) | head -n 1)"
failed=0
for program in $programs; do
    [ -s final_$program.csv ] && grep -q ",$program," times.csv || { failed=1; continue; }
    time=$(awk -F, -v p=$program -v n="$spheres" -v s="$steps" '$2 == p { print $3 / n / s * 1e9 }' times.csv | median)
    ratio=$(awk -F, -v p=$program '$2 == "scree" { own[$1] = $3 } $2 == p && own[$1] { print $3 / own[$1] }' times.csv | median)
    cp final_$program.csv spheres.csv
    # shellcheck disable=SC2046
    echo "$scene,$program,$steps,$rounds,$time,$ratio,$("$look" look $kind.toml $(sizes) | tail -n 1)"
done
awk -F, 'NR == 1 { for (k = 1; k <= NF; k++) if ($k == "x_m") first = k }
    { line = $first; for (k = first + 1; k < first + 10; k++) line = line "," $k; print line }' "$start" >spheres.csv
exit $failed
