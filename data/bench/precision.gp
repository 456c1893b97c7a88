# scree-bench precision > precision.csv; bench/peers/precision.sh build > precision_peers.csv; gnuplot precision.gp
set datafile separator ','
set terminal svg size 1000,440 dynamic enhanced font 'sans,11' background 'white'
set output 'precision.svg'
set multiplot layout 1,3
set logscale xy
set format '10^{%L}'
set xlabel 'microseconds of the processor for a contact'
set ylabel 'largest error of the rebound'
set key outside bottom center horizontal
of(who, file) = sprintf("< awk -F, '$1 == \"%s\" && $2 == \"%s\"' %s.csv", name, who, file)
do for [name in "'damped impact with tension' 'tsuji impact' 'oblique impact with tension'"] {
  set title name
  plot for [who in "lammps liggghts yade verlet pair-impulse 'pair-impulse x4'"] of(who, 'precision_peers') \
       using 6:5 with linespoints pt 7 ps 0.3 title who
}
unset multiplot
set output 'precision_cases.svg'
set terminal svg size 1500,1700 dynamic
set key off
set xlabel; set ylabel
set multiplot layout 7,4 title 'largest error over microseconds of a run: verlet (red), pair-impulse (blue), 4 substeps (green)'
cases = system("awk -F, '!/^#/ && $1 != \"case\" && !seen[$1]++ { print \"\\047\" $1 \"\\047\" }' precision.csv")
do for [name in cases] {
  set title name
  plot of('verlet', 'precision') using 6:5 with linespoints pt 7 ps 0.3 lc rgb '#c03030', \
       of('pair-impulse', 'precision') using 6:5 with linespoints pt 7 ps 0.3 lc rgb '#3060c0', \
       of('pair-impulse x4', 'precision') using 6:5 with linespoints pt 7 ps 0.3 lc rgb '#2a9d4e'
}
unset multiplot
