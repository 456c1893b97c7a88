# scree-bench precision > precision.csv; gnuplot precision.gp
set datafile separator ','
set terminal svg size 1500,1500 dynamic
set output 'precision.svg'
cases = system("awk -F, '!/^#/ && $1 != \"case\" && !seen[$1]++ { gsub(\" \", \"_\", $1); print $1 }' precision.csv")
set multiplot layout 6,4 title 'largest error over microseconds of a run: verlet (red), pair-impulse (blue), with 4 substeps (green)'
set logscale xy
set format '10^{%L}'
set key off
do for [name in cases] {
  set title system("echo '".name."' | tr _ ' '")
  of(who) = "< awk -F, '{ gsub(\" \", \"_\", $1) } $1 == \"".name."\" && $2 == \"".who."\" { print $6 \",\" $5 }' precision.csv"
  plot of('verlet') with linespoints pt 7 ps 0.4 lc rgb '#c03030', \
       of('pair-impulse') with linespoints pt 7 ps 0.4 lc rgb '#3060c0', \
       of('pair-impulse x4') with linespoints pt 7 ps 0.4 lc rgb '#2a9d4e'
}
unset multiplot
