# scree-bench stability > stability_map.csv; gnuplot stability_map.gp
set datafile separator ','
set terminal svg size 1700,700 dynamic
set output 'stability_map.svg'
set multiplot layout 2,5 title 'right (green), wrong by more than 10 % (yellow), unstable (red); line: theory'
set logscale x
set xlabel 'omega h'
set ylabel 'damping ratio'
set xrange [0.01:4]
set yrange [-0.05:2.05]
set key off
do for [who in 'verlet pair-impulse'] { do for [law in 'linear hertz tsuji hunt-crossley coulomb'] {
  set title who.', '.law
  is(word) = (strcol(1) eq who && strcol(2) eq law && strcol(6) eq word) ? $3 : NaN
  plot 'stability_map.csv' using 4:(is('right')) pt 7 ps 0.4 lc rgb '#2a9d4e', \
       '' using 4:(is('wrong')) pt 7 ps 0.4 lc rgb '#e0a000', \
       '' using 4:(is('unstable')) pt 7 ps 0.4 lc rgb '#c03030', \
       '' using 5:(strcol(1) eq who && strcol(2) eq law ? $3 : NaN) with lines lc rgb 'black'
} }
unset multiplot
