# gnuplot implicit-linearised.gp
set terminal pngcairo size 1280,760 font 'sans,13' background '#ffffff'
set output 'implicit-linearised.png'
set datafile separator ','
set title "implicit-linearised: stable time steps, scenes/hang.json\n0.5 s of motion per cell" font 'sans,16' noenhanced
set xlabel 'stiffness  [N/m]'
set ylabel 'dt  [s]' offset 1,0
set logscale xy
set format y '10^{%T}'
set format x '10^{%T}'
set tics out nomirror
set mxtics 10
set mytics 10
set border 3 lc rgb '#555555'
set key outside right top Left reverse spacing 1.35 samplen 2.2 width -2
set style fill solid 1.0 border lc rgb '#ffffff'
set xrange [4.64159:215443]
set yrange [7.51872e-05:0.0399004]
plot \
  'implicit-linearised.csv' using 1:($4==0?$2:NaN):8:9:10:11 every ::1 with boxxyerror fc rgb '#9fd3b5' title 'bounded', \
  'implicit-linearised.csv' using 1:($4==1?$2:NaN):8:9:10:11 every ::1 with boxxyerror fc rgb '#a9c9e8' title 'over-damped', \
  'implicit-linearised_border.csv' using 1:5 every ::1 with lines lw 2 dt (4,4) lc rgb '#6b7078' title 'theory: Gershgorin', \
  'implicit-linearised_border.csv' using 1:4 every ::1 with lines lw 2 dt (10,5) lc rgb '#23262b' title 'theory: at the start', \
  'implicit-linearised_border.csv' using 1:3 every ::1 with lines lw 3 lc rgb '#23262b' title 'theory: worst on the way', \
  'implicit-linearised_border.csv' using 1:2 every ::1 with points pt 7 ps 1.5 lc rgb '#23262b' title 'border, bisected', \
  'implicit-linearised_border.csv' using 1:2 every ::1 with points pt 7 ps 0.9 lc rgb '#ffffff' notitle ''
