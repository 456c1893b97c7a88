#!/bin/bash
# Impacts of a sphere (R = 10 mm, 30 g, 1 m/s) on a plane, by scree and by whatever of LAMMPS, LIGGGHTS and Yade is installed, in
# turn: run time against error. Columns are those of scree-bench precision.
usage='usage: precision.sh BUILD [CASE …] > precision_peers.csv

BUILD  a build folder of scree
CASE   linear (1e5 N/m, e = 0.5), oblique (that, 35 degrees off the normal, friction 0.3 with a spring of 8e4 N/m),
       tsuji (5e6 N/m^1.5, e = 0.5); all three if not given

1024 spheres at once, 32 phases of first touch in steps that do not divide the contact, four steps for each row of scree and
two for the others (half a step a contact to either side): the time is that of one contact of one sphere, so that what a
program spends on each step as a whole is shared by a thousand contacts, and lists have been made before (of the others,
the time of a run of no steps is taken off). Rows "alone": one sphere. Times are of the processor; those of
the others come from one long run (2000 steps a contact) less one of no steps. Errors of the rebound in parts of the speed: those
of the others are against their own limit for short steps (a comment tells it), so that they are charged with the step alone.
At the end, for each row of the others, what scree errs at the same run time.'
case ${1:--h} in -h | --help) echo "$usage" >&2; exit 2 ;; esac
[ -x "$1/bench/scree-bench" ] || { echo "precision.sh: there is no $1/bench/scree-bench" >&2; exit 2; }
build=$(realpath "$1") here=$(realpath "$(dirname "$0")")
shift
[ $# -ge 1 ] || set -- linear tsuji oblique
for case in "$@"; do
    case $case in linear | oblique | tsuji) ;; *) echo "precision.sh: there is no case \"$case\"" >&2; exit 2 ;; esac
done
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
export OMP_NUM_THREADS=1 LC_ALL=C
density=7161.9724391352911 # 0.03 kg in 4/3 pi (0.01 m)^3
gamma=786.7259035217465    # 2 zeta sqrt(k/m), zeta = 0.21545376 for e = 0.5
ladder='20 50 100 200 500' own='1 2 3 5 8 12' # steps a contact; those that scree alone takes too
fine=20000.37

duration_of() { case $1 in tsuji) echo 1.809764e-3 ;; *) echo 1.762106e-3 ;; esac; }
name_of() {
    case $1 in
    linear) echo 'damped impact with tension' ;;
    oblique) echo 'oblique impact with tension' ;;
    tsuji) echo 'tsuji impact' ;;
    esac
}

# Places and velocities of BALLS spheres.
places() { # places CASE STEP BALLS
    awk -v step="$2" -v count="$3" -v oblique="$([ "$1" = oblique ] && echo 1)" 'BEGIN {
        vx = oblique ? 0.573576436351046 : 0; vz = oblique ? -0.819152044288992 : -1
        for (k = 0; k < count; k++)
            printf "%.17g %.17g %.17g %.17g 0 %.17g\n", 0.05 * (k % 32), 0.05 * int(k / 32), 0.01 - vz * step * (k % 32 + 0.5) / 32, vx, vz
    }' >places
}

to_data() {
    awk -v density=$density -v count="$(wc -l <places)" '
        BEGIN { print "spheres\n\n" count " atoms\n1 atom types\n-1 3 xlo xhi\n-1 3 ylo yhi\n-0.1 1 zlo zhi\n\nAtoms\n" }
        { printf "%d 1 0.02 %s %s %s %s\n", NR, density, $1, $2, $3; speed[NR] = $4 " " $5 " " $6 }
        END { print "\nVelocities\n"; for (k = 1; k <= NR; k++) print k, speed[k], "0 0 0" }' places >spheres.data
}

deck_lammps() {
    case $1 in
    linear) wall="hooke/history 1.0e5 0.0 $gamma 0.0 0.0 0" ;;
    oblique) wall="hooke/history 1.0e5 8.0e4 $gamma 0.0 0.3 0" ;;
    tsuji) wall="granular hertz/material 7.5e7 0.5 0.0 tangential linear_nohistory 0.0 0.0 damping tsuji" ;;
    esac
    cat <<END
units si
atom_style sphere
boundary f f f
newton off
comm_modify vel yes
read_data spheres.data
neighbor 0.001 bin
pair_style gran/hooke/history 1.0e5 0.0 0.0 0.0 0.0 0
pair_coeff * *
fix plane all wall/gran $wall zplane 0.0 NULL
fix motion all nve/sphere
timestep $2
run $3
write_dump all custom final.dump vz vx omegay modify sort id format float %.17g
END
}

deck_liggghts() {
    case $1 in
    linear) model='hooke/stiffness' ;;
    oblique) model='hooke/stiffness tangential history' ;;
    tsuji) model='hertz' ;;
    esac
    cat <<END
units si
atom_style granular
atom_modify map array
boundary f f f
newton off
communicate single vel yes
read_data spheres.data
neighbor 0.001 bin
fix p1 all property/global kn peratomtypepair 1 1.0e5
fix p2 all property/global kt peratomtypepair 1 8.0e4
fix p3 all property/global gamman peratomtypepair 1 $gamma
fix p4 all property/global gammat peratomtypepair 1 0.0
fix p5 all property/global coefficientFriction peratomtypepair 1 0.3
fix p6 all property/global youngsModulus peratomtype 7.5e7
fix p7 all property/global poissonsRatio peratomtype 0.0
fix p8 all property/global coefficientRestitution peratomtypepair 1 0.5
pair_style gran model $model
pair_coeff * *
fix plane all wall/gran model $model primitive type 1 zplane 0.0
fix motion all nve/sphere
timestep $2
run $3
dump last all custom $3 final.dump vz vx omegay
dump_modify last sort id format "%.17g %.17g %.17g"
run 0
END
}

# PROGRAM simulates CASE with so many spheres for so many steps of so many a contact: rebounds (vz, vx, spin) go into the file
# rebounds_NUMBER, seconds of the processor are printed (those of Yade without its start).
impact() { # impact PROGRAM CASE BALLS NUMBER STEPS
    step=$(awk "BEGIN { printf \"%.17g\", $(duration_of "$2") / $4 }")
    places "$2" "$step" "$3"
    TIMEFORMAT='%3U'
    case $1 in
    lammps) to_data && deck_lammps "$2" "$step" "$5" >deck && { time lmp -sf none -in deck -log none >log 2>&1; } 2>&1 ;;
    liggghts) to_data && deck_liggghts "$2" "$step" "$5" >deck && { time liggghts -in deck -log none >log 2>&1; } 2>&1 ;;
    yade)
        CASE=$2 JOBS="$step $5 places rebounds_$4" yade -x -n -j1 "$here/precision_yade.py" >log 2>&1
        awk '/^Loop time of/ { print $4 }' log
        return
        ;;
    esac
    awk '/^ITEM: ATOMS/ { inside = 1; next } /^ITEM:/ { inside = 0 } inside && NF == 3' final.dump >"rebounds_$4"
}

steps_of() { awk "BEGIN { printf \"%d\", 1.3 * $1 + 3 }"; }

# Seconds of the processor for a step of one of so many spheres: the middle one of three.
seconds_of() { # seconds_of PROGRAM CASE BALLS NUMBER
    for _ in 1 2 3; do
        long=$(impact "$1" "$2" "$3" "$4" "$(steps_of "$4")") none=$([ "$1" = yade ] && echo 0 || impact "$1" "$2" "$3" "$4" 0)
        awk "BEGIN { printf \"%.6g\\n\", ($long - $none) / $(steps_of "$4") / $3 }"
    done | sort -g | sed -n 2p
}

programs=
command -v lmp >/dev/null && programs="$programs lammps"
command -v liggghts >/dev/null && programs="$programs liggghts"
command -v yade >/dev/null && programs="$programs yade"

# One row: two steps about N a contact.
row() { # row PROGRAM CASE N LIMIT SECONDS
    for number in $(awk "BEGIN { print $3 - 0.25, $3 + 0.25 }"); do
        impact "$1" "$2" 1024 "$number" "$(steps_of "$number")" >/dev/null
        cat "rebounds_$number"
    done | awk -v limit="$4" -v s="$5" -v case="$(name_of "$2")" -v code="$1" -v n="$3" -v duration="$(duration_of "$2")" -v numbers="$([ "$2" = oblique ] && echo 3 || echo 1)" '
        BEGIN { split(limit, l, " ") }
        { v[1] = $1; v[2] = $2; v[3] = 0.01 * $3
          for (k = 1; k <= 3; k++) { d = v[k] - l[k]; if (d < 0) d = -d; if (d > worst) worst = d; squares += d * d } }
        END { printf "%s,%s,%s,%.4g,%.3g,%.4g,%.0f,%.3g\n", case, code, n, duration / n, worst, s * n * 1e6, s * 1e9, sqrt(squares / NR / numbers) }'
}

grep -m 1 'model name' /proc/cpuinfo | sed 's/.*: /# /'
echo 'case,integrator,steps_per_contact,step_s,largest_error,run_us,ns_per_step,rms_error'
for case in "$@"; do
    for program in $programs; do
        seconds_of "$program" "$case" 1024 2000 >"seconds_$program"
        impact "$program" "$case" 32 $fine "$(steps_of $fine)" >/dev/null
        awk '{ z += $1; x += $2; w += $3 } END { printf "%.15g %.15g %.15g", z / NR, x / NR, 0.01 * w / NR }' rebounds_$fine >"limit_$program"
        echo "# $case: $program goes to $(cat "limit_$program") (vz, vx, R spin; m/s)"
    done
    for n in $own $ladder; do
        "$build/bench/scree-bench" precision --many 1024 --per "$n" --case "$(name_of "$case")" | grep -v '^#\|^case,\|reference'
        case " $own " in *" $n "*) continue ;; esac
        for program in $programs; do row "$program" "$case" "$n" "$(cat "limit_$program")" "$(cat "seconds_$program")"; done
    done | tee -a rows
    "$build/bench/scree-bench" precision --many 1 --per 500 --case "$(name_of "$case")" | grep -v '^#\|^case,\|reference' |
        sed "s/^$(name_of "$case")/& alone/"
    for program in $programs; do
        seconds=$(seconds_of "$program" "$case" 1 200000)
        awk -v case="$(name_of "$case") alone" -v code="$program" -v duration="$(duration_of "$case")" -v s="$seconds" \
            'BEGIN { printf "%s,%s,500,%.4g,,%.4g,%.0f,\n", case, code, duration / 500, s * 500e6, s * 1e9 }'
    done
done

# Least error of scree at the run time of each row of the others, on straight lines between its points (logarithms).
awk -F, '
    $2 ~ /^(verlet|pair)/ { who = $1 "," $2; n = ++count[who]; t[who, n] = log($6); e[who, n] = log($5); next }
    { rows[++others] = $0 }
    END {
        print "# at equal run time: case, program, steps a contact, microseconds, its error, that of scree, times less, by"
        for (r = 1; r <= others; r++) {
            split(rows[r], c, ","); now = log(c[6]); best = ""
            for (who in count) {
                split(who, w, ","); if (w[1] != c[1]) continue
                for (k = 1; k < count[who]; k++) if (t[who, k] <= now && now < t[who, k + 1]) {
                    guess = e[who, k] + (e[who, k + 1] - e[who, k]) * (now - t[who, k]) / (t[who, k + 1] - t[who, k])
                    if (best == "" || guess < best) { best = guess; by = w[2] }
                }
                k = count[who]
                if (now >= t[who, k] && (best == "" || e[who, k] < best)) { best = e[who, k]; by = w[2] " (its last point)" }
            }
            if (best == "") printf "# %s,%s,%s,%s,%s,,,too short a time for scree\n", c[1], c[2], c[3], c[6], c[5]
            else printf "# %s,%s,%s,%s,%s,%.2g,%.2g,%s\n", c[1], c[2], c[3], c[6], c[5], exp(best), c[5] / exp(best), by
        }
    }' rows
