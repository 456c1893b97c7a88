#!/bin/sh
# The bulk cases of `scree reproduce --suite bulk` that LAMMPS can run as well: from the grains' first places in scree, by the same
# forces. Prints what the suite measures.
usage='usage: bulk.sh BUILD FIGURES CASE [SEED]

BUILD    a build folder of scree
FIGURES  where `scree reproduce heap drum crater -o FIGURES` has written its scenes
CASE     heap, heap_rolling, drum, drum_mixed, crater
SEED     of the places (default 1)

example: bench/peers/bulk.sh build figures drum 2'
[ $# -ge 3 ] || { echo "$usage" >&2; exit 2; }
case $3 in heap | heap_rolling | drum | drum_mixed | crater) ;; *) echo "bulk.sh: there is no case \"$3\"" >&2; exit 2 ;; esac
[ -x "$1/scree" ] || { echo "bulk.sh: there is no $1/scree" >&2; exit 2; }
[ -s "$2/$3.toml" ] || { echo "bulk.sh: there is no $2/$3.toml; scree reproduce $3 -o $2 writes it" >&2; exit 2; }
build=$(realpath "$1") figures=$(realpath "$2") name=$3 seed=${4:-1}
here=$(realpath "$(dirname "$0")")
export OMP_NUM_THREADS=1 LC_ALL=C
work=$build/peers/$name-$seed
mkdir -p "$work" || exit 1
cd "$work" || exit 1

# One step of scree: the places are those of the generator.
step=$(sed -n 's/^step = //p' "$figures/$name.toml")
[ $name = drum_mixed ] && seeds="--set generate.1.seed=$seed" || seeds=
"$build/scree" run "$figures/$name.toml" -o start --set "generate.0.seed=$seed" $seeds --set "time.end=$step" --set "output.every=$step" \
    --set 'output.write=["spheres.csv"]' >/dev/null || exit 1
# Grains are of type 1 (of M2: 3), the plate, the shell and the ball of type 2. The plate's spheres are fixed, so they are read from the scene.
{
    sed -n '/^name = "plate/,/^position/p' "$figures/$name.toml" | sed -n 's/^position = \[\(.*\)\]/plate,\1,0.002,0,0,0,0,0,0,m1/p' | tr -d ' '
    tail -n +2 start/spheres.csv | tr -d '"'
} | awk -F, '
    { type = $1 ~ /^grain/ ? 1 : $1 ~ /^other/ ? 3 : 2; rows++
      atom[rows] = sprintf("%d %d %.17g %d %s %s %s", rows, type, 2 * $5, $1 == "ball" ? 7200 : type == 3 ? 2000 : 2500, $2, $3, $4)
      speed[rows] = rows " " $6 " " $7 " " $8 " " $9 " " $10 " " $11 }
    END {
        print "grains\n\n" rows " atoms\n" (name ~ /drum/ ? 3 : 2) " atom types\n\n-0.25 0.25 xlo xhi"
        print (name ~ /heap/ ? "0 0.024" : name ~ /drum/ ? "0 0.02" : "-0.25 0.25") " ylo yhi\n-0.25 0.25 zlo zhi\n\nAtoms\n"
        for (k = 1; k <= rows; k++) print atom[k]
        print "\nVelocities\n"
        for (k = 1; k <= rows; k++) print speed[k]
    }' name="$name" >grains.data
case $name in
heap_rolling) rolling='rolling sds 500 0.02 0.1' ;;
*) rolling='rolling none' ;;
esac
lmp -in "$here/bulk_${name%_*}.lammps" -sf none -log none -var data grains.data -var rolling "$rolling" >lammps.log 2>&1 ||
    { tail -n 3 lammps.log >&2; exit 1; }
case $name in
heap*)
    # As suite_bulk.c: highest grains over squares of two diameters, mean across, a line through both flanks.
    awk '/^ITEM: ATOMS/ { on = 1; next }
        on && $4 == 1 {
            left += $3 > -0.002 && $1 > -0.064 && $1 < 0.064
            i = int(($1 + 0.064) / 0.008); if ($1 < -0.064 || i > 15) next
            j = int($2 / 0.008); if (j > 2) j = 2; if (j < 0) j = 0
            if ($3 > top[i, j]) top[i, j] = $3
        }
        END {
            for (i = 0; i < 16; i++) for (j = 0; j < 3; j++) h[i] += top[i, j] / 3
            for (k = 1; k < 7; k++) { x = (k + 0.5) * 0.008; y = 0.5 * (h[k] + h[15 - k]); sx += x / 6; sy += y / 6; xy += x * y; xx += x * x }
            printf "angle_deg,%.6g\ngrains_left,%d\n", atan2(xy - 6 * sx * sy, xx - 6 * sx * sx) * 57.29577951308232, left
        }' final.dump
    ;;
drum*)
    awk '!/^#/ && $1 * 4e-5 >= 0.99999 { sum += atan2(-$2, -$3); n++ } END { printf "angle_deg,%.6g\n", sum / n * 57.29577951308232 }' centre.txt
    [ $name = drum ] ||
        awk '!/^#/ && $1 * 4e-5 >= 0.99999 && $1 * 4e-5 < 2.49999 { sum += $2 / $3; n++ } END { printf "share_of_m2,%.6g\n", sum / n }' counts.txt
    ;;
crater)
    bottom=$(awk '!/^#/ { last = $2 } END { printf "%.17g", last - 0.01 }' ball.txt)
    awk -v bottom="$bottom" '/^ITEM: ATOMS/ { on = 1; next }
        on && $4 == 1 { i = int(($1 / 0.03 + 1) * 3.5); j = int(($2 / 0.03 + 1) * 3.5); if ($3 + 0.002 > top[i, j]) top[i, j] = $3 + 0.002 }
        END { for (i = 0; i < 7; i++) for (j = 0; j < 7; j++) sum += top[i, j] / 49; printf "depth_m,%.6g\n", sum - bottom }' settled.dump
    ;;
esac
