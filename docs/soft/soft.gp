# gnuplot soft.gp makes soft.png
set terminal pngcairo size 1500,720 font 'sans,13' background '#ffffff'
set output 'soft.png'
set datafile separator ','
set multiplot layout 1,2 title "Soft bodies: pictures a second, simulated only" font 'sans,16' noenhanced
set logscale xy
set format xy '10^{%T}'
set mxtics 10
set mytics 10
set grid xtics ytics lc rgb '#dddddd'
set tics out nomirror
set border 3 lc rgb '#555555'
set key below Left reverse samplen 2 spacing 1.2 maxrows 3
set ylabel '1/s'
set xlabel 'springs'
plot \
  'soft.csv' using (strcol(1) eq 'springs-small' ? $3 : NaN):8 every ::1 with linespoints lw 2 dt 1 pt 7 ps 1.1 lc rgb '#2171b5' title 'smaller body, one step a picture', \
  'soft.csv' using (strcol(1) eq 'springs-large' ? $3 : NaN):8 every ::1 with linespoints lw 2 dt 1 pt 5 ps 1.1 lc rgb '#d7301f' title 'larger body, one step a picture', \
  'soft.csv' using (strcol(1) eq 'springs-small' ? $3 : NaN):9 every ::1 with linespoints lw 2 dt 2 pt 6 ps 1.1 lc rgb '#2171b5' title 'smaller body, stable frames', \
  'soft.csv' using (strcol(1) eq 'springs-large' ? $3 : NaN):9 every ::1 with linespoints lw 2 dt 2 pt 4 ps 1.1 lc rgb '#d7301f' title 'larger body, stable frames'
set xlabel 'vertices'
plot \
  'soft.csv' using (strcol(1) eq 'matched' ? $2 : NaN):8 every ::1 with linespoints lw 2 dt 1 pt 9 ps 1.1 lc rgb '#238b45' title 'shape matching', \
  'soft.csv' using (strcol(1) eq 'surface' ? $2 : NaN):8 every ::1 with linespoints lw 2 dt 1 pt 7 ps 1.1 lc rgb '#e08214' title 'surface springs, one step a picture', \
  'soft.csv' using (strcol(1) eq 'network' ? $2 : NaN):8 every ::1 with linespoints lw 2 dt 1 pt 5 ps 1.1 lc rgb '#6a51a3' title 'network, one step a picture', \
  'soft.csv' using (strcol(1) eq 'surface' ? $2 : NaN):9 every ::1 with linespoints lw 2 dt 2 pt 6 ps 1.1 lc rgb '#e08214' title 'surface springs, stable frames', \
  'soft.csv' using (strcol(1) eq 'network' ? $2 : NaN):9 every ::1 with linespoints lw 2 dt 2 pt 4 ps 1.1 lc rgb '#6a51a3' title 'network, stable frames', \
  'soft.csv' using (strcol(1) eq 'implicit' ? $2 : NaN):9 every ::1 with linespoints lw 2 dt 2 pt 13 ps 1.1 lc rgb '#1b1b1b' title 'network, one implicit step a frame'
unset multiplot
