# scree-bench precision > precision.csv; bench/peers/precision.sh build > precision_peers.csv; gnuplot precision.gp
set datafile separator ','
set terminal svg size 1000,360 dynamic font ',11'
set output 'precision.svg'
set multiplot layout 1,3
set logscale xy
set format '10^{%L}'
set xlabel 'microseconds of the processor for a contact'
set ylabel 'largest error of the rebound'
set key bottom left
do for [name in "'damped impact with tension' 'tsuji impact' 'oblique impact with tension'"] {
  set title name
  of(who) = (strcol(1) eq name && strcol(2) eq who) ? $5 : NaN
  plot for [who in "lammps liggghts yade verlet pair-impulse 'pair-impulse x4'"] 'precision_peers.csv' \
       using 6:(of(who)) with points pt 7 ps 0.5 title who
}
unset multiplot
set output 'precision_cases.svg'
set terminal svg size 1500,1700 dynamic
set key off
set xlabel; set ylabel
set multiplot layout 7,4 title 'largest error over microseconds of a run: verlet (red), pair-impulse (blue), 4 substeps (green)'
cases = system("awk -F, '!/^#/ && NR > 3 && !seen[$1]++ { print \"'\" $1 \"'\" }' precision.csv")
do for [name in cases] {
  set title name
  of(who) = (strcol(1) eq name && strcol(2) eq who) ? $5 : NaN
  plot 'precision.csv' using 6:(of('verlet')) with points pt 7 ps 0.4 lc rgb '#c03030', \
       '' using 6:(of('pair-impulse')) with points pt 7 ps 0.4 lc rgb '#3060c0', \
       '' using 6:(of('pair-impulse x4')) with points pt 7 ps 0.4 lc rgb '#2a9d4e'
}
unset multiplot
