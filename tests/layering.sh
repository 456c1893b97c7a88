#!/bin/sh
# The tree's own rules, checked in the sources: who may include whom, and that every exported symbol is ours.
# usage: layering.sh SOURCE_ROOT STATIC_LIBRARY SHARED_LIBRARY
root=$1 static=$(realpath "$2") shared=$(realpath "$3")
failed=0

# Folders that a folder may include; libc, OpenMP and the processor's headers are free, and the project names its folders in every include.
cd "$root" || exit 1
find bodies contact solver engine bench tests \( -name '*.c' -o -name '*.h' \) | sort | xargs awk '
BEGIN {
    may["bodies"] = "bodies"
    may["contact"] = "bodies contact"
    may["solver"] = "solver"
    may["engine"] = "bodies contact engine"
    may["engine/cli"] = "bodies contact solver engine engine/cli"
    may["bench"] = may["bench/peers"] = may["tests"] = may["engine/cli"] " bench bench/peers tests"
    libc = " assert complex ctype errno fenv float inttypes limits locale math setjmp signal stdalign stdarg stdatomic" \
        " stdbool stddef stdint stdio stdlib stdnoreturn string strings threads time unistd fcntl dirent getopt omp" \
        " pthread sys/stat sys/types sys/wait sys/mman sys/resource sys/time sys/file sched immintrin" \
        " sys/ioctl sys/syscall linux/perf_event " # the kernel header comes with that of libc
}
function among(word, words) { return index(" " words " ", " " word " ") > 0 }
function folder_of(path) { return sub(/\/[^\/]*$/, "", path) ? path : "." }
function refuse(why) {
    print FILENAME ":" FNR ": " why
    failed = 1
}
/^[[:space:]]*#[[:space:]]*include/ {
    folder = folder_of(FILENAME)
    system_header = /</
    name = $0
    sub(/^[^<"]*[<"]/, "", name)
    sub(/\.h[>"].*$/, "", name)
    # Of other solvers, there if the build finds them.
    peer = folder == "bench/peers" && name ~ /^(cminpack$|gsl\/)/
    if (system_header && !among(name, libc) && !peer) refuse("<" name ".h> is not from libc or OpenMP")
    if (!system_header && !among(folder_of(name), may[folder]))
        refuse(folder " may not include \"" name ".h\" (it may include: " may[folder] ")")
}
END { exit failed }' || failed=1

# Every symbol that the libraries define for others begins with scree_ (the sanitizers add some of their own).
strangers=$({ nm -g --defined-only "$static" 2>/dev/null; nm -D --defined-only "$shared"; } |
    awk 'NF == 3 && $3 !~ /^(scree_|__asan|__odr_asan|__ubsan|__tsan|_init$|_fini$|_edata$|_end$|__bss_start$|__gcov|__llvm|__start_|__stop_)/ {print $3}')
if [ -n "$strangers" ]; then
    echo "exported symbols without the prefix scree_: $strangers"
    failed=1
fi
# The shared library shows the public functions and nothing else.
public=$(nm -D --defined-only "$shared" | awk '$2 == "T" && $3 ~ /^scree_/ {print $3}' | sort)
declared=$(sed -n 's/^SCREE_API [^(]*[ *]\(scree_[a-z_]*\)(.*/\1/p' engine/scree.h | sort)
if [ "$public" != "$declared" ]; then
    echo "the shared library exports another set of functions than engine/scree.h declares:"
    echo "exported: $public"
    echo "declared: $declared"
    failed=1
fi

# Each public header compiles alone, as strict C17.
for header in engine/scree.h bodies/body.h bodies/motion.h bodies/shape.h bodies/trouble.h contact/choice.h; do
    echo "#include \"$header\"" | ${CC:-cc} -std=c17 -Wall -Wextra -Wpedantic -Werror -I. -fsyntax-only -x c - || failed=1
done
exit $failed
