#!/bin/sh
# One run by numbers of threads, kinds of processor and builds: all must end in the same state, bit for bit. Spheres fall from a lattice
# into a box and settle (scree-bench hot).
usage='usage: same_bits.sh STEPS BUILD...

STEPS   of the run; 20000 are 0.2 s, until the spheres lie
BUILD   build folders of scree, say one of gcc and one of clang

example: bench/same_bits.sh 20000 build build-clang'
[ $# -ge 2 ] || { echo "$usage" >&2; exit 2; }
steps=$1
shift
case $steps in 0* | *[!0-9]*) echo "same_bits.sh: STEPS is a whole number from 1 on, not \"$steps\"" >&2; exit 2 ;; esac
for build in "$@"; do
    [ -x "$build/bench/scree-bench" ] || { echo "same_bits.sh: there is no $build/bench/scree-bench" >&2; exit 2; }
done
export OMP_WAIT_POLICY=passive # more threads than cores
first=

try() { # try BUILD ISA THREADS
    row=$(SCREE_ISA=$2 "$1/bench/scree-bench" hot --bodies 10000 --settle "$steps" --steps 1 --repeats 1 --threads "$3" | tail -n 1)
    hash=${row##*,}
    [ -n "$hash" ] || { echo "same_bits.sh: $1/bench/scree-bench failed" >&2; exit 1; }
    echo "$1,${row%%,*},$3,$steps,$hash"
    first=${first:-$hash}
    [ "$hash" = "$first" ] || { echo "same_bits.sh: the state differs" >&2; exit 1; }
}

echo 'build,isa,threads,steps,hash'
for build in "$@"; do
    for threads in 1 2 3 4 7 16; do try "$build" "" $threads; done
    for isa in baseline avx2; do try "$build" $isa 2; done
done
