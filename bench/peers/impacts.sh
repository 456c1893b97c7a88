#!/bin/sh
# Single impacts of a sphere (R = 10 mm, 30 g) on a plane at 1 m/s, by other programs: largest error over 32 phases of first touch,
# with steps that don't divide the contact, and the time of a contact step. Cases and their exact rebounds are those of
# scree-bench precision and scree impact:
#   linear   1e5 N/m, e = 0.5                       duration 1.762106 ms
#   tsuji    5e6 N/m^1.5, e = 0.5                   duration 1.809764 ms
#   oblique  linear, with friction 0.3 and a spring of 8e4 N/m sideways, 35 degrees off the normal
# 1024 spheres at once, 32 of each phase, four steps for each row, half a step a contact to either side. Errors in parts of the speed: against the exact rebound (of what was asked for), and
# against the program's own limit for short steps (what the step alone is guilty of).
# usage: impacts.sh > impacts.csv
here=$(mktemp -d) || exit 1
trap 'rm -rf "$here"' EXIT
cd "$here" || exit 1
export OMP_NUM_THREADS=1 LC_ALL=C
density=7161.9724391352911 # 0.03 kg in 4/3 pi (0.01 m)^3
gamma=786.7259035217465    # 2 zeta sqrt(k/m), zeta = 0.21545376 for e = 0.5

duration_of() { case $1 in tsuji) echo 1.8097640e-3 ;; *) echo 1.7621059e-3 ;; esac; }

# Positions with their phases, velocities: for read_data.
write_data() { # write_data CASE STEP
    awk -v step="$2" -v oblique="$([ "$1" = oblique ] && echo 1)" -v density=$density 'BEGIN {
        vx = oblique ? 0.573576436351046 : 0; vz = oblique ? -0.819152044288992 : -1
        print "spheres\n\n1024 atoms\n1 atom types\n-1 3 xlo xhi\n-1 3 ylo yhi\n-0.1 1 zlo zhi\n\nAtoms\n"
        for (k = 0; k < 1024; k++)
            printf "%d 1 0.02 %.17g %.17g %.17g %.17g\n", k + 1, density, 0.05 * (k % 32), 0.05 * int(k / 32), 0.01 - vz * step * (k % 32 + 0.5) / 32
        print "\nVelocities\n"
        for (k = 0; k < 1024; k++) printf "%d %.17g 0 %.17g 0 0 0\n", k + 1, vx, vz
    }' >spheres.data
}

deck_lammps() {
    case $1 in
    linear) wall="hooke/history 1.0e5 0.0 $gamma 0.0 0.0 0" ;;
    oblique) wall="hooke/history 1.0e5 8.0e4 $gamma 0.0 0.3 0" ;;
    # Asked for 0.5, LAMMPS delivers 0.616: this is what to ask for.
    tsuji) wall="granular hertz/material 7.5e7 0.3666513615687179 0.0 tangential linear_nohistory 0.0 0.0 damping tsuji" ;;
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

# Run CASE in PROGRAM with so many steps a contact; leaves final.dump and prints the seconds.
impact() { # impact PROGRAM CASE STEPS_PER_CONTACT
    step=$(awk "BEGIN { printf \"%.17g\", $(duration_of "$2") / $3 }")
    steps=$(awk "BEGIN { printf \"%d\", 1.3 * $3 + 3 }")
    write_data "$2" "$step"
    "deck_$1" "$2" "$step" "$steps" >deck
    rm -f final.dump
    case $1 in
    lammps) lmp -sf none -in deck -log none >log 2>&1 || tail -n 3 log >&2 ;;
    liggghts) liggghts -in deck -log none >log 2>&1 || tail -n 3 log >&2 ;;
    esac
    awk -v steps="$steps" '/^Loop time of/ { print $4 / steps / 1024; exit }' log
}

numbers='/^ITEM: ATOMS/ { inside = 1; next } /^ITEM:/ { inside = 0 } inside && NF == 3'

measure() { # measure PROGRAM CASE EXACT (vz, vx, R omega)
    impact "$1" "$2" 20000.37 >/dev/null
    limit=$(awk "$numbers { z += \$1; x += \$2; w += \$3; n++ } END { printf \"%.15g %.15g %.15g\", z / n, x / n, 0.01 * w / n }" final.dump)
    for n in 10 15 20 30 50 100 200 500; do
        : >errors
        for part in 0.12 0.37 0.62 0.87; do
            seconds=$(impact "$1" "$2" "$(awk "BEGIN { print $n - 0.5 + $part }")")
            awk -v exact="$3" -v limit="$limit" -v seconds="$seconds" "
                BEGIN { split(exact, e, \" \"); split(limit, l, \" \") }
                $numbers { v[1] = \$1; v[2] = \$2; v[3] = 0.01 * \$3
                    for (k = 1; k <= 3; k++) {
                        d = v[k] - e[k]; if (d < 0) d = -d; if (d > worst) worst = d
                        d = v[k] - l[k]; if (d < 0) d = -d; if (d > own) own = d
                    } }
                END { print seconds, worst, own }" final.dump >>errors
        done
        sort -g errors | awk -v code="$1" -v case="$2" -v n="$n" '{ t[NR] = $1 } $2 > worst { worst = $2 } $3 > own { own = $3 }
            END { printf "%s,%s,%s,%.3g,%.3g,%.3g\n", code, case, n, worst, own, (t[2] + t[3]) / 2 }'
    done
}

echo 'code,case,steps_per_contact,largest_error,largest_error_of_steps,seconds_per_contact_step'
for program in lammps liggghts; do
    command -v $([ $program = lammps ] && echo lmp || echo $program) >/dev/null || continue
    measure $program linear '0.5 0 0'
    measure $program tsuji '0.5 0 0'
    measure $program oblique '0.40957602214440336 0.32033927496263448 0.63309290347102898'
done
