#!/bin/sh
# The program as a user meets it: exit codes, messages, files. usage: program.sh PROGRAM SOURCE_ROOT
scree=$(realpath "$1") root=$(realpath "$2")
work=$(mktemp -d) || exit 1
trap 'chmod -R u+w "$work"; rm -rf "$work"' EXIT
failed=0 checks=0
scenes=$root/data/scenes

# check NAME EXPECTED_CODE PATTERN COMMAND…: exit status, and a pattern in what it prints (standard output and error).
check() {
    name=$1 expected=$2 pattern=$3
    shift 3
    checks=$((checks + 1))
    printed=$("$@" 2>&1)
    code=$?
    if [ $code -ne "$expected" ]; then
        echo "$name: exit status $code, expected $expected; printed: $printed" | head -c 2000
        failed=1
    fi
    case $printed in
    *"$pattern"*) ;;
    *) echo "$name: \"$pattern\" is missing in: $printed" | head -c 2000; failed=1 ;;
    esac
}
expect() { # expect NAME CONDITION…
    name=$1
    shift
    checks=$((checks + 1))
    "$@" || { echo "$name: failed: $*"; failed=1; }
}
nothing_left() { expect "nothing is left of it" test ! -e "$1"; }

check version 0 'scree 0.' "$scree" --version
check help 0 'usage: scree COMMAND' "$scree" --help
check 'no command' 2 'usage' "$scree"
check 'unknown command' 2 'did you mean "check"?' "$scree" chek
for command in run check reproduce plan impact fit laws; do check "$command --help" 0 'example:' "$scree" $command --help; done
check 'unknown option' 2 'did you mean "--threads"?' "$scree" run --thread 2
check 'missing value' 2 'needs a value' "$scree" run x.toml -o
check 'a sweep of too many points' 2 'whole number from 2' "$scree" impact --law 'hertz modulus=1e8' --sweep speed=1:2:4294967298
check 'bad number' 2 'whole number' "$scree" run x.toml --threads two
check 'two scenes' 2 'takes one scene file' "$scree" run a b

check 'a wish with a sweep' 2 'goes with --law, --ball, --host and --speed only' "$scree" impact --law 'linear stiffness=1e5' --want damping=0.5 --sweep speed=1:2:3
check 'a table of forces in an impact' 2 'only a scene file' "$scree" impact --law 'table file=forces.csv'
check 'an impact too deep for a scene' 0 'a scene would be stopped there' "$scree" impact --law 'linear stiffness=100 damping=0' --speed 10
check 'a law of another kind' 2 'is a normal law, no friction law' "$scree" check "$scenes/bounce.toml" --set 'contact.0.friction={law="linear"}'
check 'a law without a like' 2 'scree laws' "$scree" impact --law qqq
check 'a parameter without a like' 2 'it has stiffness, restitution, damping' "$scree" impact --law 'linear qqq=1'
check 'rolling: a parameter without a like' 2 'no parameter "resistance"; it has rolling' "$scree" check "$scenes/bounce.toml" --set 'contact.0.rolling={law="spring-dashpot", resistance=0.1}'
check 'sleep while gravity tilts' 2 'with time.sleep=1e-4: no body sleeps while gravity tilts' "$scree" check "$scenes/incline.toml" --set time.sleep=1e-4
check 'a bad law that is not used' 2 'no normal law called' "$scree" check "$scenes/bounce.toml" --set contact.0.none=true --set 'contact.0.normal={law="nonsense"}'
check 'an end between steps' 0 'steps (to 0.05001 s)' "$scree" check "$scenes/bounce.toml" --set time.end=0.05 --set time.step=3e-5

check laws 0 'linear-loading' "$scree" laws
check 'one law' 0 'restitution e wanted' "$scree" laws linear
check 'no such law' 2 'did you mean "hunt-crossley"?' "$scree" laws hunt-crosley
for law in $("$scree" laws | sed -n 's/^  \([a-z0-9-]*\) .*/\1/p'); do check "laws $law" 0 'source:' "$scree" laws "$law"; done

# Steps that are stable but too coarse: told at the end.
coarse() { # coarse STEP: an elastic impact, 0.0017 s long
    cat >"$work/coarse.toml" <<END
[time]
end = 0.01
step = $1
integrator = "verlet"
[output]
write = ["energy.csv"]
every = 1e-3
[[material]]
name = "m"
[[contact]]
between = ["m", "m"]
normal = { law = "linear", stiffness = 1e5, damping = 0.0 }
[[body]]
name = "floor"
shape = { plane = true }
material = "m"
joint = "fixed"
[[body]]
name = "ball"
shape = { sphere = 0.01 }
material = "m"
mass = 0.03
position = [0, 0, 0.0112]
velocity = [0, 0, -1]
END
}
# A row at the very touch, where rounding is all that has been turned over, is no reason for a warning.
cat >"$work/touch.toml" <<'END'
[time]
step = 1e-5
end = 2e-3
integrator = "pair-impulse"
[output]
every = 5e-4
write = ["energy.csv"]
[[material]]
name = "g"
density = 2500
young = 1e8
poisson = 0.25
[[contact]]
between = ["g", "g"]
normal = { law = "dmt", adhesion = 5.0 }
[[motion]]
name = "up"
kind = "velocity"
velocity = 0.01
[[body]]
name = "ball"
shape = { sphere = 0.01 }
mass = 1e6
material = "g"
position = [0, 0, 0.010005]
[[body]]
name = "floor"
shape = { plane = true }
material = "g"
joint = { x = "fixed", y = "fixed", z = "up", turn = "fixed" }
END
check 'books at the touch' 0 'written to' "$scree" run "$work/touch.toml" -o "$work/touch"
case $printed in *warning*) echo "books at the touch: $printed"; failed=1 ;; esac

# Neither is what spheres that rest are off by at rounding.
cat >"$work/lattice.toml" <<'END'
[time]
end = 0.01
[output]
write = ["energy.csv"]
[[material]]
name = "m"
density = 1000
[[contact]]
between = ["m", "m"]
normal = { law = "linear", stiffness = 1e4, restitution = 0.5 }
[[generate]]
name = "g"
kind = "lattice"
material = "m"
min = [0, 0, 0]
max = [1.5, 1.5, 1.5]
radius = 1e-3
count = 100
END
expect 'books of a lattice at rest' test -z "$("$scree" run "$work/lattice.toml" --quiet -o "$work/lattice" 2>&1)"

# Spheres from a generator; where they are at the end begins another scene, in every bit.
spheres() { # spheres TABLE
    cat <<END
[time]
end = 1e-3
step = 1e-4
[output]
write = ["bodies.csv", "spheres.csv"]
[[material]]
name = "glass, clear"
density = 2500
[[contact]]
between = ["glass, clear", "glass, clear"]
normal = { law = "linear", stiffness = 10, restitution = 0.6 }
$1
END
}
spheres '[[generate]]
name = "# grain"
kind = "random"
material = "glass, clear"
radius = [1e-3, 2e-3]
min = [0, 0, 0]
max = [0.02, 0.02, 0.02]
count = 40
velocity = [0.1, 0, 0]' >"$work/grains.toml"
check 'generated spheres' 0 'written to' "$scree" run "$work/grains.toml" -o "$work/grains"
spheres '[[spheres]]
file = "grains/spheres.csv"' >"$work/again.toml"
sed 's/grains\///' "$work/again.toml" >"$work/astray.toml"
check 'a table that is missing' 2 'astray.toml:13:8: ' "$scree" check "$work/astray.toml"
check 'it is named, and why' 2 'spheres.csv: No such file' "$scree" check "$work/astray.toml"
check 'spheres read again' 0 'written to' "$scree" run "$work/again.toml" -o "$work/again"
tail -n +2 "$work/grains/spheres.csv" | sed 's/,"glass, clear"$//' | cut -d, -f1-4,6-8 >"$work/end"
sed -n '2,41p' "$work/again/bodies.csv" | cut -d, -f2-5,10-12 >"$work/start"
expect 'the same 40 spheres' test "$(wc -l <"$work/end")" = 40
expect 'in every bit' cmp "$work/end" "$work/start"
# What a scene is read from isn't written over, by whatever name.
cp "$work/grains/spheres.csv" "$work/grains.csv"
ln -s grains "$work/alias"
cp "$work/again.toml" "$work/grains/bodies.csv"
over() { "$scree" run "$work/again.toml" -o "$work/grains" "$@"; }
check 'over its own table' 2 'spheres.csv: the scene is read from this file' over
check 'over that by another name' 2 'spheres.csv: the scene is read from this file' over --set 'spheres.0.file="alias/spheres.csv"'
check 'over the scene itself' 2 'bodies.csv: the scene is read from this file' "$scree" run "$work/grains/bodies.csv" -o "$work/grains" \
    --set 'spheres.0.file="spheres.csv"' --set 'output.write=["bodies.csv"]'
expect 'nothing of it is left' test -z "$(find "$work/grains" -name '*.part')"
expect 'the table is as it was' cmp "$work/grains.csv" "$work/grains/spheres.csv"
check 'beside its own table' 0 'written to' over --set 'output.write=["energy.csv"]'
expect 'the table is still as it was' cmp "$work/grains.csv" "$work/grains/spheres.csv"
spheres '[[body]]
name = "shot"
shape = { sphere = 1e-3 }
mass = 0.3
material = "glass, clear"
[[body]]
name = "bead"
shape = { sphere = 1e-3 }
material = "glass, clear"
position = [0.01, 0, 0]' >"$work/shot.toml"
check 'a sphere with a mass of its own' 0 'written to' "$scree" run "$work/shot.toml" -o "$work/shot"
spheres '[[spheres]]
file = "shot/spheres.csv"' >"$work/shots.toml"
check 'masses read again' 0 'written to' "$scree" run "$work/shots.toml" -o "$work/shots"
expect 'its mass' grep -q '^shot,0,0,0,0.001,0.29999999999999999,0,' "$work/shots/spheres.csv"
expect 'that of the density' cmp "$work/shot/spheres.csv" "$work/shots/spheres.csv"

# The ball pressed between two walls: what is off before each halving stays in the result, and is told.
coarse 3.8e-4
cat >>"$work/coarse.toml" <<'END'
[[body]]
name = "lid"
shape = { plane = true }
material = "m"
joint = "fixed"
position = [0, 0, 0.018]
orientation = { axis = [1, 0, 0], degrees = 180 }
END
check 'what halvings leave is told' 0 'over all halvings the energy books were off by' \
    "$scree" run "$work/coarse.toml" -o "$work/squeezed" --set time.end=3.8 --set time.integrator='"pair-impulse"' \
    --set time.watch='"halve"' --set body.ball.position=[0,0,0.009] \
    --set body.ball.velocity=[0,0,1e-4] --set output.every=4 --set time.substeps=1

# The scenes of many spheres; in a periodic one gravity points along the chute, and books close all the same.
check 'bed' 0 'written to' "$scree" run "$scenes/bed.toml" -o "$work/bed" --set time.end=0.002 --set output.every=0.001
expect 'bed: spheres' test "$(wc -l <"$work/bed/spheres.csv")" = 501
check 'plan of a chute' 0 'periodic along x, every 0.012 m, y, every 0.006 m' "$scree" check "$scenes/chute.toml"
check 'chute' 0 'written to' "$scree" run "$scenes/chute.toml" -o "$work/chute" --set time.end=0.01
expect 'chute: frames' test -s "$work/chute/frames/spheres_000002.vtp"
check 'the second half of a chute' 0 'state hash' "$scree" run "$scenes/chute.toml" -o "$work/chute-long" --set time.end=0.02 --resume "$work/chute/final.state"
second=$(printf '%s\n' "$printed" | sed -n 's/^state hash: //p')
check 'both halves at once' 0 "state hash: $second" "$scree" run "$scenes/chute.toml" -o "$work/chute-whole" --set time.end=0.02 --threads 2
check 'another period' 2 'what differs: bodies or their joints, start positions or velocities, periodic domain' "$scree" run "$scenes/chute.toml" \
    -o "$work/chute-long" --set domain.max=[0.013,0.006,0.03] --set generate.base.max=[0.013,0.006,0.0005] --set time.end=0.02 --resume "$work/chute/final.state"

coarse 1e-3
check 'coarse step: books' 0 'the energy books lack' "$scree" run "$work/coarse.toml" -o "$work/coarse"
check 'coarse step' 0 'more than a tenth of the shortest contact' "$scree" run "$work/coarse.toml" -o "$work/coarse"
coarse 1e-4
expect 'fine step: no warning' test -z "$("$scree" run "$work/coarse.toml" --quiet -o "$work/coarse" 2>&1)"
check 'haste' 0 'it only grazes' "$scree" run "$work/coarse.toml" -o "$work/coarse" --set 'body.ball.velocity=[0,0,40]'

# Two bodies meet. The rule of a rigid body that slides: e_t = 1 - mu (1 + e) = 0.81 at 45 degrees.
slides='ramp kinetic=0.1 threshold=1e-6'
check 'impact: too fast to be followed' 1 "can't be followed" "$scree" impact --law 'linear stiffness=1e5 restitution=0.5' --speed 1e12
check 'impact: too steep' 1 ',unfinished' "$scree" impact --law 'linear stiffness=1e5 damping=1e6'
check 'impact: a row' 0 'tsuji-cut,none,1,0,0,0,0.9' "$scree" impact --law 'tsuji-cut modulus=1e8 restitution=0.9'
expect 'impact: slides' test "$("$scree" impact --law 'linear-cut stiffness=1e5 restitution=0.9' --friction "$slides" --angle 45 |
    awk -F, 'NR == 2 { print (($7 - 0.9)^2 < 1e-18 && ($8 - 0.81)^2 < 1e-18) }')" = 1
expect 'impact: a sweep side by side' test "$("$scree" impact --law 'linear stiffness=1e5' --law 'linear-cut stiffness=1e5' \
    --sweep law.restitution=0.2:1:5 | awk -F, '/^linear/ && ($3 - $8)^2 < 1e-18' | wc -l)" = 10
expect 'impact: by ratio' test "$("$scree" impact --law 'hertz modulus=1e8' --sweep speed=0.01:10:4:log | cut -d, -f3 | tail -n 1)" = 10
check 'impact: unit of what is swept' 0 'law.modulus_Pa,' "$scree" impact --law hertz --sweep law.modulus=1e6:1e9:4:log
check 'impact: a loop' 0 'time_s,overlap_m,' "$scree" impact --law 'hertz modulus=1e8' --loop
check 'impact: two spheres' 0 'hertz,none,' "$scree" impact --law hertz --ball 'sphere radius=0.01 mass=0.01 young=1e9 poisson=0.3' \
    --host 'sphere radius=0.02 density=2000 young=1e9 poisson=0.3'
check 'impact: a corner' 0 'linear,none,' "$scree" impact --law 'linear stiffness=1e5 damping=0' \
    --ball 'box x=0.1 y=0.2 z=0.3 mass=6 tilt_x=20 tilt_y=30'
check 'impact: a folder' 0 'written to' "$scree" impact --law 'hertz modulus=1e8' --friction "$slides" --sweep angle=0:80:9 -o "$work/impact"
expect 'impact: its tables' test "$(grep -c '^hertz,ramp,' "$work/impact/impact.csv")" = 9 -a -s "$work/impact/loop.csv"
check 'impact: glue holds what comes slowly' 0 ',stayed' "$scree" impact --law 'jkr modulus=1e8 adhesion=1' --ball 'sphere radius=0.001 density=2500' \
    --speed 1e-3
if command -v gnuplot >/dev/null; then expect 'impact: its plot' grep -q '</svg>' "$work/impact/impact.svg"; fi
for wrong in "did you mean \"hertz\"?|--law|herz modulus=1" "did you mean \"modulus\"?|--law|hertz modulu=1" \
    "not both|--law|tsuji modulus=1e8 alpha=1 restitution=0.5" "neither is given|--law|tsuji modulus=1e8" \
    "must be > 0|--law|hertz modulus=-1" "takes a number|--law|hertz modulus=x" "stiffness takes a finite number|--law|linear stiffness=inf" \
    "tilt_x takes a finite number|--ball|box x=1 y=1 z=1 mass=1 tilt_x=inf" "expected NAME=NUMBER|--law|hertz modulus" \
    "given twice|--law|hertz modulus=1 modulus=2" "young|--law|hertz" "has no \"radios\"|--ball|sphere radios=1" \
    "needs radius= (m)|--ball|sphere mass=1" "needs y= (m)|--ball|box x=1 mass=1" "either mass|--ball|sphere radius=1" "not both|--ball|sphere radius=1 mass=1 density=1" "no shape|--ball|cube x=1" \
    "a plane can't move|--ball|plane" "takes a number|--speed|x" "speed must be|--speed|-1" "below 90|--angle|90" \
    "to sweep|--sweep|spede=1:2:3" "COUNT|--sweep|speed=1:2:1" "must be > 0|--sweep|speed=0:1:3:log" \
    "no --friction|--sweep|friction.kinetic=0:1:3" "takes NAME=FROM:TO:COUNT|--sweep|speed=1:2"; do
    message=${wrong%%|*} rest=${wrong#*|}
    set -- "${rest%%|*}" "${rest#*|}"
    [ "$1" = --law ] || set -- "$@" --law 'linear stiffness=1e5 damping=0'
    check "impact: $*" 2 "$message" "$scree" impact "$@"
    expect "impact: nothing is printed for $*" test -z "$("$scree" impact "$@" 2>/dev/null)"
done
check 'impact: a sharp corner' 2 'give the box a rounding' "$scree" impact --law 'hertz modulus=1e8' --ball 'box x=1 y=1 z=1 mass=1'
check 'impact: asked for' 0 'linear,0.5,1,damping,23.60177' "$scree" impact --want damping=0.5 --law 'linear stiffness=1e5' \
    --law 'blend stiffness=1e5 full=2e-4' --ball 'sphere radius=0.02 mass=0.03'
check 'impact: asked for what damps nothing' 2 'no damping that could be chosen' "$scree" impact --want stiffness=0.5 --law 'hertz stiffness=1e7'
check 'impact: swept twice' 2 '--sweep is given more than 1 time' "$scree" impact --law 'hertz modulus=1e8' --sweep speed=1:2:3 --sweep angle=1:2:3
check 'impact: measured forces' 2 'only a scene file' "$scree" impact --law table
check 'impact: asked for what is not there' 2 'did you mean "damping"' "$scree" impact --want dampin=0.5 --law 'linear stiffness=1e5'
check 'impact: asked for nothing' 2 'takes KEY=E' "$scree" impact --want damping --law 'linear stiffness=1e5'
check 'impact: no law' 2 'needs a normal law' "$scree" impact

for scene in "$scenes"/*.toml; do check "check $scene" 0 'step:' "$scree" check "$scene"; done
check 'check from standard input' 0 'bodies: 3' sh -c "'$scree' check - <'$scenes/incline.toml'"

# The README's scene and the commands under it, as they stand there.
section() { sed -n '/^## A scene, from file to plot/,/^## The map/p' "$root/README.md" | sed -n "/^\`\`\`$1/,/^\`\`\`\$/p" | sed '/^```/d'; }
section toml >"$work/readme.toml"
check 'scene of the README' 0 'bodies: 2' "$scree" check "$work/readme.toml"
mkdir "$work/readme" "$work/readme/build"
ln -s "$scree" "$work/readme/build/scree"
ln -s "$root/data" "$work/readme/data"
section sh | grep '^build/' >"$work/readme/commands"
expect 'commands of the README' test "$(wc -l <"$work/readme/commands")" -ge 2
check 'commands of the README' 0 'written to bounce' sh -ec "cd '$work/readme' && . ./commands"
if command -v gnuplot >/dev/null; then
    section sh | sed '/^build/d' >"$work/readme/plot"
    check 'plot of the README' 0 '' sh -ec "cd '$work/readme' && . ./plot"
    expect 'plot of the README is drawn' grep -q '</svg>' "$work/readme/bounce/height.svg"
fi
# Every key that scene files may have stands in the README's section about them.
sed -n '/^## Scene files/,/^## Many/p' "$root/README.md" >"$work/keys.md"
cat "$root/engine/scene_file.c" "$root/engine/scene_spheres.c" | sed -n '/char \*const \(keys\|common\)\[\]/,/;/p' | grep -o '"[a-z_]*"' |
    tr -d '"' | sort -u >"$work/keys"
expect 'keys of scene files' test "$(wc -l <"$work/keys")" -ge 50
for key in $(cat "$work/keys"); do expect "the README has the key $key" grep -qw "$key" "$work/keys.md"; done
# The same of fit files.
sed -n '/^## Fitting/,/^## The suites/p' "$root/README.md" >"$work/keys.md"
sed -n '/char \*const keys\[\]/,/;/p' "$root/engine/cli/fit_file.c" | grep -o '"[a-z_]*"' | tr -d '"' | sort -u >"$work/keys"
expect 'keys of fit files' test "$(wc -l <"$work/keys")" -ge 12
for key in $(cat "$work/keys"); do expect "the README has the key $key" grep -qw "$key" "$work/keys.md"; done
# Whatever runs of the tree's scenes leave in the tree is ignored there.
for scene in "$scenes"/*.toml "$root"/data/transport/*.toml "$root"/data/fit/*.toml; do
    expect "the folder of $scene is ignored" grep -q "^/$(basename "$scene" .toml)/" "$root/.gitignore"
done

# A short run: what it writes.
out=$work/out
check run 0 'state hash' "$scree" run "$scenes/transport.toml" -o "$out" --set time.end=0.02 --set time.step=1e-5
for file in bodies.csv contacts.csv energy.csv scene.pvd final.state frames/boxes_000020.vtp frames/contacts_000020.vtp \
    frames/spheres_000020.vtp; do
    expect "run writes $file" test -s "$out/$file"
done
expect 'no temporary file is left' test -z "$(find "$out" -name '*.part')"
expect 'header with units' test "$(head -n 1 "$out/bodies.csv" | cut -d, -f1-3)" = time_s,body,x_m
expect '21 rows for each of 5 bodies that move' test "$(wc -l <"$out/bodies.csv")" -eq 106
expect 'numbers in full' grep -q '^0.00[0-9]*,product,0.01[0-9]\{15,\}' "$out/bodies.csv"
expect 'frames are listed' test "$(grep -c DataSet "$out/scene.pvd")" -eq 63
check 'default folder' 0 'written to incline' sh -c "cd '$work' && '$scree' run '$scenes/incline.toml' --set time.end=1e-3"
expect 'default folder is made' test -s "$work/incline/bodies.csv"
check 'quiet' 0 '' "$scree" run "$scenes/incline.toml" -o "$work/quiet" --quiet --set time.end=1e-3
expect 'quiet prints nothing' test -z "$("$scree" run "$scenes/incline.toml" -o "$work/quiet" --quiet --set time.end=1e-3 2>&1)"

# A run in two parts ends with the same bits as one.
hash_of() { sed -n 's/^state hash: //p'; }
whole=$("$scree" run "$scenes/incline.toml" -o "$work/whole" --set time.end=0.2 2>&1 | hash_of)
"$scree" run "$scenes/incline.toml" -o "$work/half" --set time.end=0.1 --quiet
"$scree" run "$scenes/incline.toml" -o "$work/plain" --set time.end=0.1 --set 'output.write=[]' --quiet
resumed=$("$scree" run "$scenes/incline.toml" -o "$work/rest" --set time.end=0.2 --resume "$work/half/final.state" 2>&1 | hash_of)
expect 'resumed run has the same hash' test -n "$whole" -a "$whole" = "$resumed"
expect 'its books end with the same figures' test "$(tail -n 1 "$work/whole/energy.csv")" = "$(tail -n 1 "$work/rest/energy.csv")"
threaded=$("$scree" run "$scenes/incline.toml" -o "$work/threads" --set time.end=0.2 --threads 2 2>&1 | hash_of)
expect 'threads have the same hash' test "$whole" = "$threaded"
silent=$("$scree" run "$scenes/incline.toml" -o "$work/silent" --set time.end=0.2 --set 'output.write=[]' 2>&1 | hash_of)
expect 'without output the same hash' test "$whole" = "$silent"
# Interrupted while it runs: the state of then goes on to the same end.
"$scree" run "$scenes/bounce.toml" -o "$work/broken" --set time.end=1e5 --set output.every=10 --set time.step=4e-5 --quiet 2>"$work/broken.text" &
running=$!
while [ ! -e "$work/broken/bodies.csv.part" ] && kill -0 $running 2>/dev/null; do sleep 0.05; done
sleep 0.3
kill $running # its interrupt is ignored in the background
wait $running
expect 'an interrupted run ends by its signal' test $? -eq 143
expect 'an interrupted run says where' grep -q 'interrupted at t = .*final.state.part goes on from there' "$work/broken.text"
expect 'an interrupted run keeps no results' test ! -e "$work/broken/bodies.csv" -a ! -e "$work/broken/final.state"
end=$(sed -n 's/.*interrupted at t = \([0-9.e+-]*\) s.*/\1/p' "$work/broken.text" | awk '{ printf "%.9g", $1 + 0.1 }')
whole=$("$scree" run "$scenes/bounce.toml" -o "$work/unbroken" --set time.end="$end" --set output.every=10 --set time.step=4e-5 2>&1 | hash_of)
resumed=$("$scree" run "$scenes/bounce.toml" -o "$work/mended" --set time.end="$end" --set output.every=10 --set time.step=4e-5 --resume "$work/broken/final.state.part" 2>&1 | hash_of)
expect 'an interrupted run goes on to the same end' test -n "$whole" -a "$whole" = "$resumed"
check 'a resumed run goes on' 2 'nothing is left to simulate' "$scree" run "$scenes/incline.toml" -o "$work/x0" \
    --set time.end=0.1 --resume "$work/half/final.state"
nothing_left "$work/x0"
check 'another gravity' 2 'what differs: gravity' "$scree" run "$scenes/incline.toml" -o "$work/x0" --set time.end=0.2 \
    --set 'gravity.vector=[0,0,-9.8]' --resume "$work/half/final.state"
check 'energy books from the middle' 0 'energy books begin at t = 0.1 s' "$scree" run "$scenes/incline.toml" -o "$work/books" \
    --set time.end=0.11 --resume "$work/plain/final.state"

# Resumed with an automatic step that the new end would change, without a folder named, and with one that holds the first half.
bounce() { (cd "$work" && "$scree" run "$scenes/bounce.toml" --set 'output={write=["bodies.csv"]}' "$@"); }
bounce --quiet --set time.end=0.1
first=$(cksum <"$work/bounce/bodies.csv")
check 'step from the state' 0 'as it was up to the state' bounce --set time.end=0.213 --resume bounce/final.state
expect 'default folder of a resumed run' test -s "$work/bounce-resumed/bodies.csv"
expect 'the first half is as it was' test "$first" = "$(cksum <"$work/bounce/bodies.csv")"
check 'into the same folder' 2 'would be overwritten' bounce --set time.end=0.3 --resume bounce/final.state -o ./bounce/
check 'into the same folder by way of a new one' 2 'would be overwritten' bounce --set time.end=0.3 --resume bounce/final.state -o bounce/new/..
ln -s bounce/final.state "$work/linked.state"
check 'into the same folder from a link' 2 'would be overwritten' bounce --set time.end=0.3 --resume linked.state -o bounce
mkdir "$work/hard"
ln "$work/bounce/final.state" "$work/hard/final.state"
mv "$work/bounce/final.state" "$work/bounce/half.state"
check 'the state by a name of its own' 2 'would be overwritten' bounce --set time.end=0.3 --resume hard/final.state -o bounce
mv "$work/bounce/half.state" "$work/bounce/final.state"
check 'the same state in another folder' 2 'would be overwritten' bounce --set time.end=0.3 --resume hard/final.state -o bounce
check 'twice into the default folder' 2 'would be overwritten' bounce --set time.end=0.3 --resume bounce-resumed/final.state
expect 'the first half is still as it was' test "$first" = "$(cksum <"$work/bounce/bodies.csv")"

# A step far too long, halved where the run goes wrong; the second half of such a run goes on with the step that it had.
coarse() { bounce --set time.integrator='"verlet"' --set time.step=2e-3 --set time.force=true --set output.every=0.02 "$@"; }
check 'a string without quotes' 2 'a string stands in quotes' bounce --set time.integrator=verlet
check 'a step too long stops' 1 'stopped at t = ' coarse -o long
check 'a step too long is halved' 0 'on with half the step, 0.001 s' coarse --set time.watch='"halve"' -o halved
expect 'rows in spite of halving' test "$(tail -n 1 "$work/halved/bodies.csv" | cut -d, -f1)" = 1
whole=$(coarse --set time.watch='"halve"' -o halved 2>&1 | hash_of)
coarse --quiet --set time.watch='"halve"' --set time.end=0.6 -o halved1 2>"$work/halvings"
expect 'each halving is told' test "$(grep -c 'half the step' "$work/halvings")" -eq 2
resumed=$(coarse --set time.watch='"halve"' --resume halved1/final.state -o halved2 2>&1 | hash_of)
expect 'a halved run resumed has the same hash' test -n "$whole" -a "$whole" = "$resumed"
check 'accuracy in the plan' 0 'by trial impacts' "$scree" check "$scenes/bounce.toml" --set time.accuracy=1e-3

{ cat "$work/half/final.state"; echo; } >"$work/longer.state"
check 'state with more behind it' 2 'goes on behind its end' "$scree" run "$scenes/incline.toml" -o "$work/x4" --set time.end=0.2 --resume "$work/longer.state"
nothing_left "$work/x4"
check 'state of another scene' 2 'another scene' "$scree" run "$scenes/transport.toml" -o "$work/x1" --resume "$work/half/final.state"
nothing_left "$work/x1"
check 'state that is none' 2 'no state file' "$scree" run "$scenes/incline.toml" -o "$work/x2" --resume "$scenes/incline.toml"
check 'state that is a folder' 2 'Is a directory' "$scree" run "$scenes/incline.toml" -o "$work/x3" --resume "$work/half"
check 'state that is missing' 2 'No such file' "$scree" run "$scenes/incline.toml" -o "$work/x3" --resume "$work/none"

# Rows fall on multiples of `every`, from wherever a run goes on; a row a step at the most.
rows_of() { tail -n +2 "$work/$1/bodies.csv" | cut -d, -f1 | tr '\n' ' '; }
bounce --quiet --set time.step=1e-4 --set time.end=0.01 --set output.every=0.0025 -o rows
expect 'rows' test "$(rows_of rows)" = '0 0.0025 0.005 0.0075 0.01 '
bounce --quiet --set time.step=1e-4 --set time.end=0.02 --set output.every=0.003 --resume rows/final.state -o rows2
expect 'rows of the second half' test "$(rows_of rows2)" = '0.01 0.012 0.015 0.018 0.02 '
bounce --quiet --set time.step=1e-4 --set time.end=0.002 --set output.every=1e18 -o rows3
expect 'rows farther apart than the run is long' test "$(rows_of rows3)" = '0 0.002 '
check 'rows closer than the step' 2 'closer than the step' bounce --set time.step=1e-4 --set output.every=1e-300
check 'more rows than steps can be' 2 'rows every 1e-300 s up to t = ' bounce --set 'time.step="auto"' --set output.every=1e-300
check 'more frames than numbers' 2 'would be 1e+07; the most is 999999' "$scree" check "$scenes/bounce.toml" --set output.every=1e-7
check 'a run for ever' 2 'the most is 1e+15' bounce --set time.end=1e300
check 'check of a run for ever' 2 'the most is 1e+15' "$scree" check "$scenes/bounce.toml" --set time.end=1e300
check 'rows for ever' 2 'the most is 1e+15' "$scree" check "$scenes/bounce.toml" --set output.every=1e-300
check 'title with an escape sequence' 0 'a\x1b[31mb' "$scree" check "$scenes/bounce.toml" --set 'title="a\u001b[31mb"'
check 'no folder' 2 'folder for the results is empty' bounce -o ''
check 'no folder for figures' 2 'folder for the results is empty' "$scree" reproduce -o ''

# Bad input: one message, exit status 2, nothing written.
check 'missing scene' 2 'No such file' "$scree" run "$work/none.toml" -o "$work/x4"
nothing_left "$work/x4"
check 'scene is a folder' 2 'directory' "$scree" run "$work" -o "$work/x5"
printf 'title = "x"\n[time]\nend = 1\nstp = 2\n' >"$work/bad.toml"
check 'unknown key set' 2 'with time.foo=3: unknown key "foo" in [time]' "$scree" check "$scenes/bounce.toml" --set time.foo=3
check 'unknown table set' 2 'there is no "tim" in this file; did you mean "time"?' "$scree" check "$scenes/bounce.toml" --set tim.end=3
check 'contact by a number too many' 2 'there is no "1" in this file: entries are numbered from 0 to 0' "$scree" check \
    "$scenes/bounce.toml" --set contact.1.normal.restitution=1
check 'unknown body set' 2 'there is no "bal" in this file; did you mean "ball"?' "$scree" check "$scenes/bounce.toml" --set body.bal.mass=3
check 'a table set that the file lacks' 2 'starts outside of the domain' "$scree" check "$scenes/bounce.toml" \
    --set 'domain.min=[-9,-9,-9]' --set 'domain.max=[9,9,0.1]'
check 'a table set that there is not' 2 'unknown key "shapes" in the scene' "$scree" check "$scenes/bounce.toml" --set shapes.end=3
check 'a transport file to run' 2 'unknown key "transport" in the scene; this looks like a file for scree plan' "$scree" run "$scenes/../transport/bars.toml" -o "$work/x6"
check 'a scene to fit' 2 'in the fit file; this looks like a file for scree run' "$scree" fit "$scenes/bounce.toml" -o "$work/x6"
check 'unknown key' 2 "bad.toml:4:1: unknown key \"stp\" in [time]; did you mean \"step\"?" "$scree" run "$work/bad.toml" -o "$work/x6"
nothing_left "$work/x6"
expect 'one line of message' test "$("$scree" run "$work/bad.toml" 2>&1 | wc -l)" -eq 1
check 'bad override' 2 'there is no "nobody"' "$scree" run "$scenes/incline.toml" --set body.nobody.mass=1 -o "$work/x7"
check 'step too large' 2 'stability limit' "$scree" run "$scenes/incline.toml" --set time.step=0.01 -o "$work/x8"
nothing_left "$work/x8"
check 'step forced' 0 'FORCED BEYOND IT' "$scree" check "$scenes/incline.toml" --set time.step=0.01 --set time.force=true \
    --set output.every=0.1
head -c 104857600 /dev/zero | tr '\0' '[' >"$work/huge.toml"
check '100 MB of brackets' 2 'too large' "$scree" check "$work/huge.toml"
head -c 1000000 "$work/huge.toml" >"$work/deep.toml"
check 'a million brackets' 2 'deep.toml:1:' "$scree" check "$work/deep.toml"
rm "$work/huge.toml"
head -c 300000 /dev/urandom >"$work/noise.toml"
check 'noise' 2 'noise.toml:' "$scree" check "$work/noise.toml"

# Output that can't be written: an error, and what was there stays.
check 'folder under a file' 2 'Not a directory' "$scree" run "$scenes/incline.toml" -o "$work/bad.toml/out"
if [ -w /dev/full ]; then
    check 'full standard output' 2 'standard output' sh -c "'$scree' laws >/dev/full"
fi
# A whole run, then a shorter one, then one that fails.
frames='output={every=0.01, write=["bodies.csv", "vtk"]}'
slide() { "$scree" run "$scenes/impact_and_slide.toml" -o "$work/kept" --set "$frames" "$@"; }
sums() { (cd "$work/kept" && find . -type f ! -name '*.part' ! -path './frames.part/*' | sort | xargs cksum); }
slide --quiet --set time.end=0.05
expect 'frames of the longer run' test -s "$work/kept/frames/boxes_000005.vtp"
echo mine >"$work/kept/frames/notes.txt"
slide --quiet --set time.end=0.02
expect 'no frames of the longer run are left' test "$(find "$work/kept" -name '*.vtp' | wc -l)" -eq 9
expect 'all frames are listed' test "$(grep -c 'file="frames/' "$work/kept/scene.pvd")" -eq 9
for file in $(sed -n 's/.*file="\(.*\)".*/\1/p' "$work/kept/scene.pvd"); do expect "$file" test -s "$work/kept/$file"; done
expect "what isn't ours is kept" grep -q mine "$work/kept/frames/notes.txt"
expect 'nothing else is there' test "$(cd "$work/kept" && echo *)" = 'bodies.csv final.state frames scene.pvd'
before=$(sums)
check 'a run that fails' 1 'stopped at t =' slide --set 'contact.0.normal={law="linear", stiffness=10.0, damping=0.0}'
case $printed in
*'stopped at t ='*'is left in'*) ;;
*) echo "the reason doesn't come first: $printed"; failed=1 ;;
esac
expect 'existing output is kept' test "$before" = "$(sums)"
check 'tables of another run' 0 'kept also holds what this run hasn'"'"'t written: bodies.csv, scene.pvd' "$scree" run "$scenes/impact_and_slide.toml" -o "$work/kept" --set 'output={write=[]}' --quiet
"$scree" run "$scenes/bounce.toml" -o "$work/both" --quiet --set time.end=1e9 --set output.every=1e6 &
long=$!
tries=0
while [ ! -e "$work/both/bodies.csv.part" ] && [ $tries -lt 100 ]; do
    sleep 0.1
    tries=$((tries + 1))
done
check 'two runs into one folder' 2 'final.state.part: another run is writing it' "$scree" run "$scenes/bounce.toml" -o "$work/both"
check 'two runs, other tables' 2 'another run is writing it' "$scree" run "$scenes/bounce.toml" -o "$work/both" --set 'output.write=["vtk"]'
kill $long
wait $long 2>/dev/null
check 'one after the other' 0 'written to' "$scree" run "$scenes/bounce.toml" -o "$work/both" --set time.end=0.01
expect 'rows up to the stop are there' test -s "$work/kept/bodies.csv.part"
expect 'frames up to the stop are there' test -s "$work/kept/frames.part/boxes_000000.vtp"
slide --quiet --set time.end=0.02
expect 'a whole run clears them away' test "$(cd "$work/kept" && echo *)" = 'bodies.csv final.state frames scene.pvd'
check 'a full disk' 2 'File too large' sh -c \
    "trap '' XFSZ; ulimit -f 16; '$scree' run '$scenes/incline.toml' -o '$work/kept' --set time.end=0.3 --set 'output.write=[\"vtk\", \"bodies.csv\"]'"
expect 'nothing of it is left, nothing is lost' test "$before" = "$(sums)" -a "$(cd "$work/kept" && echo *)" = 'bodies.csv final.state frames scene.pvd'
check 'too large a file' 2 'bodies.csv: File too large' sh -c \
    "trap '' XFSZ; ulimit -f 16; '$scree' run '$scenes/incline.toml' -o '$work/limited' --set time.end=0.3 --set 'output.write=[\"bodies.csv\"]'"
nothing_left "$work/limited/bodies.csv"
nothing_left "$work/limited/bodies.csv.part"

# What would be in the way of new frames is told at the beginning, here of a run that would stop.
for wrong in frames frames.old; do
    out=$work/way-$wrong
    mkdir "$out"
    echo mine >"$out/$wrong"
    check "$wrong is a file" 2 "/$wrong is no folder" coarse -o "$out" --set "$frames"
    expect 'and is all that is there' test "$(cat "$out/$wrong")" = mine -a "$(ls "$out")" = "$wrong"
done
mkdir -p "$work/way/frames.old"
touch "$work/way/frames.old/spheres_000000.vtp" "$work/way/frames.old/notes.txt"
check 'notes beside old frames' 2 '/frames.old is in the way' coarse -o "$work/way" --set "$frames"
rm "$work/way/frames.old/notes.txt"
check 'old frames alone' 0 'written to' bounce -o "$work/way" --set "$frames" --set time.end=0.02
nothing_left "$work/way/frames.old"

# Figures: with gnuplot and without.
check 'an unknown path of the processor' 2 'baseline, avx2 or avx512, not "avx9"' env SCREE_ISA=avx9 "$scree" laws
check 'an empty one is none' 0 '' env SCREE_ISA= "$scree" laws
check 'list of figures' 0 '11b' "$scree" reproduce --list
expect 'list of all' test "$("$scree" reproduce --list | grep -c .)" -gt 40
expect 'list of those named' test "$("$scree" reproduce --list 11b 12 | grep -c .)" = 2
check 'list of a figure that is not there' 2 'no figure "99"' "$scree" reproduce --list 99
check 'a suite' 0 'bounds met' "$scree" reproduce --suite chung-ooi -o "$work/suite"
check 'cases of a suite' 0 '21 of 21 bounds met' "$scree" reproduce rolling viscoelastic edge corner painleve stack cradle top \
    -o "$work/suite"
check 'an unknown suite' 2 'did you mean "mfix"' "$scree" reproduce --suite mfx -o "$work/suite"
check 'no such figure' 2 'no figure "99"' "$scree" reproduce 99
check 'a figure without its letter' 2 'no figure "5"; did you mean "5a"?' "$scree" reproduce 5
check 'figures without gnuplot' 0 "gnuplot can't be started" env PATH=/nonexistent "$scree" reproduce -o "$work/figures" 9 11b
for file in fig_9.csv fig_9.gp fig_11b.csv report.csv; do expect "reproduce writes $file" test -s "$work/figures/$file"; done
nothing_left "$work/figures/fig_9.svg"
normal_laws=$("$scree" laws | sed -n '/^normal/,/^friction/s/^  \([a-z0-9-]*\) .*/\1/p')
check 'figure 8' 0 'bounds met' env PATH=/nonexistent "$scree" reproduce -o "$work/figures" 8
friction_laws=$("$scree" laws | sed -n '/^friction/,/^rolling/s/^  \([a-z0-9-]*\) .*/\1/p')
for law in $friction_laws; do expect "figure 9 draws $law" grep -q "^\"$law\"," "$work/figures/fig_9.csv"; done
for law in $normal_laws; do expect "figure 8 draws $law" grep -q "^\"$law\"," "$work/figures/fig_8.csv"; done
mkdir "$work/bad"
printf '#!/bin/sh\nfor script; do echo "<svg>" >"${script%%.gp}.svg"; done\nexit 1\n' >"$work/bad/gnuplot"
chmod +x "$work/bad/gnuplot"
check 'figures when gnuplot fails' 1 'failed on 2 of the plots' env PATH="$work/bad:$PATH" "$scree" reproduce -o "$work/unplotted" 8 9
check 'impact: gnuplot fails' 1 'failed on 2 of the plots' env PATH="$work/bad:$PATH" "$scree" impact --law 'hertz modulus=1e8' \
    --sweep speed=1:2:3 -o "$work/unplotted"
nothing_left "$work/unplotted/fig_8.svg"
expect 'all data are there when it fails' test -s "$work/unplotted/fig_8.csv" -a -s "$work/unplotted/fig_9.csv" -a -s "$work/unplotted/report.csv"
if command -v gnuplot >/dev/null; then
    check 'figures with gnuplot' 0 'bounds met' "$scree" reproduce -o "$work/figures" 9
    expect 'a plot is drawn' grep -q '</svg>' "$work/figures/fig_9.svg"
fi
check 'data folder' 2 'No such file' "$scree" reproduce -o "$work/figures" --data "$work" 11b

# Plans.
transport=$root/data/transport
check 'figures of the plan' 0 '31 of 31 bounds met' env PATH=/nonexistent "$scree" reproduce -o "$work/figures" 5b 14 15
plan() { env PATH=/nonexistent "$scree" plan "$@" -o "$work/plan"; }
check 'a plan' 0 'hybrid operation: conventional up to 81.5' plan "$transport/bars.toml" --set 'plan.speeds=[500]' --set map.to=320 \
    --set curves.count=3 --set curves.from=400
for file in plan.csv map.csv map.gp curves.csv servo_500.csv; do expect "plan writes $file" test -s "$work/plan/$file"; done
expect 'the planned motion' grep -q '^500,good,0.0[0-9]*,0.0[0-9]*,0.0[0-9]*,0.0[0-9]*,1.8211[0-9]*,0.4434[0-9]*,1.7354[0-9]*,' "$work/plan/plan.csv"
cp "$work/plan/servo_500.csv" "$work/first.csv"
check 'threads change nothing' 0 'written to' plan "$transport/bars.toml" --threads 3 --set 'plan.speeds=[400, 500]' \
    --set map.to=320 --set curves.count=3 --set curves.from=400
expect 'the same table' cmp "$work/first.csv" "$work/plan/servo_500.csv"
check 'a rigid plan' 0 'times chosen at 800' plan "$transport/rigid.toml"
check 'the first times that work lower down' 0 'with times = [0.35, 0.375, 0.625] a rigid product is placed from 86.8 to 98.44; between 81.5 and 87 no' \
    plan "$transport/rigid.toml" --set 'plan.speeds=[500]'
# Plans of formulation A for all speeds are one plan, scaled: two knots do, whatever the process model makes of them.
check 'a map of rigid plans' 0 'map: 2 knots' plan "$transport/bars.toml" --set 'plan.formulation="A"' --set 'plan.speeds=[500]' \
    --set curves.count=2 --set curves.from=400 --set model.step=2e-5
check 'too slow for a plan' 1 'no plan: after the catch the comb brakes too softly' plan "$transport/bars.toml" --set 'plan.speeds=[90]' \
    --set map.to=310 --set curves.count=2 --set curves.from=400
bad_plan() { check "$1" 2 "$2" plan "$transport/bars.toml" --set "$3"; }
bad_plan 'a gap narrower than the product' 'is not wider than the product' transport.gap=0.02
bad_plan 'times that decrease' 'must increase between 0 and 1' 'transport.times=[0.5, 0.25, 0.75]'
bad_plan 'speed zero' 'an operating speed must be positive' 'plan.speeds=[0]'
bad_plan 'an unknown key' 'did you mean "tine_stiffness"' model.tine_stifness=1.0
bad_plan 'no such scene' 'No such file' 'model.scene="nothing.toml"'
bad_plan 'speeds as a word' 'needs speeds = ' 'plan.speeds="fast"'
bad_plan 'static below kinetic' 'must not be below kinetic' model.static=0.1
bad_plan 'no such formulation' 'formulation must be one of "A", "B", "C"' 'plan.formulation="D"'
bad_plan 'a product that slides for months' '3.64e+06 s, until friction (3e-07 m/s^2) has stopped the product' transport.gravity=1e-6
check 'beyond the drive' 1 'the drive gives 1000' plan "$transport/bars.toml" --set 'plan.speeds=[1200]' --set map.to=310 --set curves.count=2 --set curves.from=400
# What an earlier plan left: replaced as a whole, or not at all; what isn't ours stays.
out=$work/replaced
replan() { env PATH=/nonexistent "$scree" plan "$transport/rigid.toml" -o "$out" "$@"; }
check 'two speeds of six equal digits' 0 'written to' replan --set 'plan.speeds=[300, 333.333331, 333.333332, 300]' --set 'map={from=300, to=310}'
for file in servo_300.csv servo_333.333331.csv servo_333.333332.csv map.csv map.gp; do expect "$file" test -s "$out/$file"; done
echo mine >"$out/servo_notes.csv"
sed '/^optimise/d' "$transport/rigid.toml" >"$work/rigid.toml"
sums_of() { (cd "$out" && cksum *); }
before=$(sums_of)
check 'a table without end' 2 'rows' replan --set servo.rate=1e300
expect 'nothing of the earlier plan is lost' test "$before" = "$(sums_of)"
mkdir "$out/servo_400.csv.part"
check 'a table that can not be written' 2 'servo_400.csv' replan --set 'plan.speeds=[300, 400]'
rmdir "$out/servo_400.csv.part"
expect 'nothing of the earlier plan is lost' test "$before" = "$(sums_of)"
check 'no plan at all' 1 'no speed has a plan: nothing is written' env PATH=/nonexistent "$scree" plan "$work/rigid.toml" -o "$out" \
    --set transport.friction=30
expect 'nothing of the earlier plan is lost' test "$before" = "$(sums_of)"
check 'fewer speeds' 0 'removed from' replan --set 'plan.speeds=[300]'
expect 'only files of this plan and others' test "$(cd "$out" && echo *)" = 'plan.csv servo_300.csv servo_notes.csv'
check 'no time shares' 1 'no time shares found' env PATH=/nonexistent "$scree" plan "$transport/rigid.toml" -o "$work/unmade" \
    --set transport.gap=0.06
nothing_left "$work/unmade"
check 'lift without a return' 2 'no time for the return' replan --set transport.share=1

# A servo table is a motion table.
sed -n '/^\[transport\]/,/^optimise/p' "$transport/rigid.toml" | sed '/^optimise/d' >"$work/feed.toml"
printf '[plan]\nspeeds = [500]\n[servo]\nrate = 700\nlift = 0.02\n' >>"$work/feed.toml"
cat >"$work/fed.toml" <<'END'
gravity = [0, 0, 0]
[time]
end = 0.12
step = 1e-5
[[material]]
name = "m"
[[motion]]
name = "stroke"
kind = "table"
file = "fed/servo_500.csv"
[[body]]
name = "comb"
material = "m"
mass = 1
shape = { sphere = 0.01 }
joint = { x = "stroke", others = "fixed" }
[output]
every = 0.03
END
# fed NAME TIME COLUMN VALUE OPTIONS…: where the comb is at a time, to 1e-12 m.
fed() {
    name=$1 time=$2 column=$3 value=$4
    shift 4
    check "$name" 0 '' "$scree" run "$work/fed.toml" -o "$work/fed" --quiet "$@"
    expect "$name" awk -F, -v t="$time" -v c="$column" -v x="$value" \
        '$1 - t < 1e-9 && t - $1 < 1e-9 { found = $c - x < 1e-12 && x - $c < 1e-12 } END { exit !found }' "$work/fed/bodies.csv"
}
check 'a table of the stroke' 0 'written to' "$scree" plan "$work/feed.toml" -o "$work/fed" --set 'servo={rate=700}'
fed 'end of the stroke' 0.06 3 0.06
fed 'the slowest' 0.03 10 "$(sed -n 2p "$work/fed/plan.csv" | cut -d, -f8)" --set 'motion.stroke.interpolation="velocity-quintic"'
check 'a table of the map' 0 'map: 2 knots' "$scree" plan "$work/feed.toml" -o "$work/fed" --set 'servo={rate=700, map=true}' \
    --set 'map={from=300, to=700, bound=1, weight="n"}'
slowest=$(awk -F, 'NR > 1 { sum += $6 } END { printf "%.17g", sum / 2 / 0.06 }' "$work/fed/map.csv")
fed 'the slowest of the map' 0.03 10 "$slowest" --set 'motion.stroke.interpolation="velocity-quintic"'
check 'a table outside of the map' 2 'need a [map] whose range holds all speeds, got 500' "$scree" plan "$work/feed.toml" \
    -o "$work/fed" --set servo.map=true --set 'map={from=600, to=700}'
check 'a table of no map' 2 'need a [map]' "$scree" plan "$work/feed.toml" -o "$work/fed" --set servo.map=true
check 'a table of the cycle' 0 'written to' "$scree" plan "$work/feed.toml" -o "$work/fed"
fed 'end of the stroke in a cycle' 0.06 3 0.06 --set 'motion.stroke.interpolation="quintic"'
fed 'the lift' 0.09 3 0.02 --set 'motion.stroke={name="stroke", kind="table", file="fed/servo_500.csv", axis="lift", interpolation="quintic"}'
check 'no such axis' 2 'did you mean "lift"' "$scree" check "$work/fed.toml" --set 'motion.stroke.axis="lfit"'
check 'axis of rows' 2 'rows have one axis' "$scree" check "$work/fed.toml" \
    --set 'motion.stroke={name="stroke", kind="table", rows=[[0, 0], [1, 1]], axis="lift"}'

# Limits in words.
check 'play beyond a third of the way' 1 'there is no plan for a rigid product at any speed: the comb would move backwards' replan \
    --set 'transport={distance=0.08, gap=0.06, width=0.03, friction=0.3}'
check 'little play' 0 'formulation A, rigid product): from n_low = 762.' replan --set 'transport={distance=0.08, gap=0.0301, width=0.03, friction=0.3}' \
    --set 'plan.speeds=[800]'
check 'a weak drive' 1 'it can'"'"'t be run' replan --set 'transport={distance=0.08, gap=0.05, width=0.03, friction=0.3}' \
    --set 'drive={acceleration=5}' --set 'plan.speeds=[300]'
check 'far from its place' 1 'ends farther than 1 mm' plan "$transport/bars.toml" --set model.mass=0.5 --set 'plan.speeds=[500]' \
    --set map.to=310 --set curves.count=2 --set curves.from=400
check 'restitution of 1' 0 'written to' plan "$transport/bars.toml" --set model.tine_restitution=1 --set 'plan.speeds=[500]' \
    --set map.to=310 --set curves.count=2 --set curves.from=400
expect 'all sensitivities are there' test "$(sed -n 2p "$work/plan/plan.csv" | tr ',' '\n' | grep -c .)" -eq 25
expect 'none of them is naught' test "$(sed -n 2p "$work/plan/plan.csv" | cut -d, -f21-25 | tr ',' '\n' | grep -c '^0$')" -eq 0
sed '/^name = "left rear tine"/s/left/first/' "$scenes/transport.toml" >"$work/lacking.toml"
check 'a scene that lacks a body' 2 'lacking.toml: a process model needs a body "left rear tine"' plan "$transport/bars.toml" \
    --set "model.scene=\"$work/lacking.toml\""
check 'a restitution above 1' 2 'must be > 0 and <= 1' plan "$transport/bars.toml" --set model.tine_restitution=1.5
check 'no model' 2 'needs a [model]' plan "$transport/rigid.toml" --set 'plan.formulation="C"'

# Fits. The records of data/fit are made with restitution = 0.55, stiffness = 8e4 N/m and noise of 5 mm/s, which is 1.2 % of
# the change of velocity; 301 readings, half of them after the impact, give 1e-3 and less.
cat >"$work/fit.toml" <<END
body = "product"
set = ["contact.1.normal.restitution={restitution}", "contact.1.normal.stiffness={stiffness}"]
[parameter]
restitution = { start = 0.5, min = 0.05, max = 1 }
stiffness = { start = 1e5, min = 1e3 }
[[experiment]]
scene = "$scenes/restitution.toml"
record = "$root/data/fit/impact.csv"
[[experiment]]
scene = "$scenes/restitution.toml"
record = "$root/data/fit/impact.csv"
END
fit() { "$scree" fit "$work/fit.toml" -o "$work/fit" "$@"; }
check 'fit' 0 'stiffness' fit
expect 'fit: both are found' awk -F, -v OFS=, '$1 == "restitution" { a = ($2 - 0.55)/$3 } $1 == "stiffness" { b = ($2 - 8e4)/$3 }
    END { exit !(a^2 < 16 && b^2 < 16) }' "$work/fit/fit.csv"
expect 'fit: errors as small as readings allow' awk -F, '$1 == "restitution" { exit !($3 < 1e-3) }' "$work/fit/fit.csv"
expect 'fit: a row a reading' test "$(wc -l <"$work/fit/record_2.csv")" -eq 302
expect 'fit: a script for the plot' test -e "$work/fit/record_2.gp"
sed '/^\[\[experiment/,$d' "$work/fit.toml" >"$work/part.toml"
sed -n '/^\[\[experiment/,$p' "$work/fit.toml" | sed 3q >>"$work/part.toml"
sed -i 's/^\[\[experiment.*/&\ndelay = "delay"/; s/^\[parameter.*/&\ndelay = { start = 0, difference = 1e-6, min = -1e-4, max = 0 }/' "$work/part.toml"
sed -i 's/^set = \[/&"time.end=0.0062", /' "$work/part.toml"
check 'fit: a clock that is right' 0 'delay' "$scree" fit "$work/part.toml" -o "$work/fit"
expect 'fit: no record of an earlier one is left' test ! -e "$work/fit/record_2.csv" -a ! -e "$work/fit/record_2.gp"
cp "$work/fit/fit.csv" "$work/kept.csv"
check 'fit: a change to the file' 2 'start must be from min to max' fit --set parameter.restitution.start=2
check 'fit: a body with a like' 2 'no body called "prdct"; did you mean "product"?' fit --set 'body="prdct"'
check 'fit: a scene that stops' 2 'there is no "3"' fit --set 'set=["contact.3.normal.restitution={restitution}", "time.speed={stiffness}"]'
check 'fit: nothing tells a parameter' 1 'not told by the records' fit \
    --set 'set=["contact.1.normal.restitution={restitution}", "body.product.spin=[0,0,0]", "time.speed={stiffness}"]' -o "$work/untold"
expect 'fit: what was there stays' cmp -s "$work/kept.csv" "$work/fit/fit.csv"
mkdir "$work/own"
cp "$root/data/fit/impact.csv" "$work/own/record_1.csv"
cp "$root/data/fit/impact.csv" "$work/own/record_3.csv"
check 'fit: records where results would go' 2 'name another one with -o' fit --set "experiment.0.record=\"$work/own/record_1.csv\"" -o "$work/own"
check 'fit: there by way of a new folder' 2 'name another one with -o' fit --set "experiment.0.record=\"$work/own/record_1.csv\"" -o "$work/own/new/.."
rmdir "$work/own/new"
ln -s own/record_1.csv "$work/linked.csv"
check 'fit: a link to one there' 2 'name another one with -o' fit --set "experiment.0.record=\"$work/linked.csv\"" -o "$work/own"
expect 'fit: they are as they were' cmp -s "$root/data/fit/impact.csv" "$work/own/record_1.csv"
check 'fit: beside files of such names' 0 'written to' fit -o "$work/own"
expect 'fit: what it has not written stays' cmp -s "$root/data/fit/impact.csv" "$work/own/record_3.csv"
check 'fit: into a file' 2 'Not a directory' fit -o "$work/fit.toml/deep"
echo stale >"$work/own/record_1.svg"
check 'fit: without gnuplot' 0 "can't be started" env PATH="$work" "$scree" fit "$work/fit.toml" -o "$work/own"
expect 'fit: no plot of other data stays' test ! -e "$work/own/record_1.svg"
check 'fit: no file' 2 'No such file' "$scree" fit "$work/none.toml" -o "$work/nothing"
check 'fit: no record' 2 'with experiment.1.record="none.csv": '"$work"'/none.csv: No such file' fit --set 'experiment.1.record="none.csv"' -o "$work/nothing"
nothing_left "$work/nothing"

echo "$checks checks, $([ $failed -eq 0 ] && echo none || echo some) failed"
exit $failed
