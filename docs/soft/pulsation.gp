# gnuplot pulsation.gp
set terminal pngcairo size 1280,620 font 'sans,13' background '#ffffff'
set output 'pulsation.png'
set datafile separator ','
set title "Size of a ball at rest under its own goals" font 'sans,16'
set xlabel 'time  [s]'
set ylabel 'size over that at the start' offset 1,0
set logscale y
set yrange [0.02:20]
set xrange [0:3]
set tics out nomirror
set border 3 lc rgb '#555555'
set key outside right top Left reverse spacing 1.5 samplen 2.2 width -2
set grid y lc rgb '#e3e3e3'
plot \
  'unrooted-pq.csv' using 2:3 with lines lw 2 lc rgb '#d1495b' title 'A_{pq} (A_{pq}^T A_{pq})^{-1}, 1 kg', \
  'unrooted-pq-heavy.csv' using 2:3 with lines lw 2 lc rgb '#e8a25a' title 'A_{pq} (A_{pq}^T A_{pq})^{-1}, 362 kg', \
  'unrooted-linear.csv' using 2:3 with lines lw 6 lc rgb '#9fc3e5' title 'A (A^T A)^{-1}, A = A_{pq} A_{qq}^{-1}', \
  'polar.csv' using 2:3 with lines lw 2 lc rgb '#23262b' title 'A_{pq} (A_{pq}^T A_{pq})^{-1/2}: rotation'
