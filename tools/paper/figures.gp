# Draws the pictures from points.csv; both are in the current folder.
set encoding utf8
set terminal svg size 860,440 font "Helvetica,15" background "white"
set datafile separator comma
set logscale xy
set format xy "10^{%T}"
set tics nomirror
set border 3 lw 1.2
set grid xtics ytics lc rgb "#dddddd" lw 1 dt solid
set lmargin at screen 0.11
set rmargin at screen 0.7
set key at screen 0.72, graph 0.75 left top Left reverse samplen 2.5 spacing 1.4

set style line 1 lc rgb "#d55e00" lw 2 pt 4  ps 1.3
set style line 2 lc rgb "#0072b2" lw 2 pt 7  ps 0.8
set style line 3 lc rgb "#009e73" lw 2 pt 9  ps 1.0
set style line 4 lc rgb "#222222" lw 2 pt 13 ps 1.0
set style line 5 lc rgb "#909090" lw 1.5 dt (6,5)  # computed, not measured; the constants below are fitted to one machine
engines = "brute tree slice scan"
names = "'brute force' 'tree (ADT)' 'slicing' 'scan (default)'"

# The rows that an awk condition picks. Columns: 3 facets, 4 n, 5 cells, 6 rays, 8 cast, 9 run, 10 memory.
rows(input, engine, condition) = sprintf("< awk -F, '$1 == \"%s\" && $2 == \"%s\" && %s' points.csv", input, engine, condition)
# Facets, and nanoseconds per ray: by how much the rays of n = 2154 cost more than those of n = 464.
per_ray(engine) = "< awk -F, -v OFS=, '$1 == \"bust\" && $2 == \"" . engine . "\" && $4 == 464 {cast[$3] = $8; rays[$3] = $6} " . \
                  "$1 == \"bust\" && $2 == \"" . engine . "\" && $4 == 2154 {print $3, 1e9 * ($8 - cast[$3]) / ($6 - rays[$3])}' points.csv"
# The number of facets of the unchanged inputs, which alone are meshed on the largest grids.
facets(input, n) = system(sprintf("awk -F, '$1 == \"%s\" && $4 == %d {print $3; exit}' points.csv", input, n))
bust = facets("bust", 10000)
stadium = facets("stadium", 4642)

set output "facets-bust.svg"
set title "bust, 1000³ cells, 10⁶ rays"
set xlabel "facets"
set ylabel "CPU time of casting, s"
set xrange [100:1e7]
set yrange [0.01:100]
plot for [i=1:4] rows("bust", word(engines, i), "$4 == 1000") using 3:8 with linespoints ls i title word(names, i), \
     2.1e-3 * x with lines ls 5 title "∝ facets"

set output "facets-stadium.svg"
set title "stadium, 1000 × 800 × 200 cells, 160,000 rays"
set xrange [1000:1e7]
plot for [i=1:4] rows("stadium", word(engines, i), "$4 == 1000") using 3:8 with linespoints ls i title word(names, i), \
     4.6e-4 * x with lines ls 5 title "∝ facets"

set output "ray.svg"
set title "bust, one ray more"
set ylabel "CPU time, ns"
set xrange [100:1e7]
set yrange [10:1e5]
plot rows("bust", "brute", "$4 == 1000") using 3:(1e9 * $8 / $6) with linespoints ls 1 title word(names, 1), \
     for [i=2:4] per_ray(word(engines, i)) using 1:2 with linespoints ls i title word(names, i), \
     11 * log(x) / log(2) with lines ls 5 title "∝ log facets"

set output "cells-bust.svg"
set title "bust, " . bust . " facets"
set xlabel "cells"
set ylabel "CPU time of casting, s"
set xrange [5e4:2e12]
set yrange [3e-4:100]
plot for [i=1:4] rows("bust", word(engines, i), "$3 == " . bust) using 5:8 with linespoints ls i title word(names, i), \
     1.1e-7 * x ** (2. / 3) with lines ls 5 title "∝ cells^{2/3}"

set output "cells-stadium.svg"
set title "stadium, " . stadium . " facets"
set ylabel "CPU time of the whole run, s"
set xrange [1e5:1e11]
set yrange [0.01:1000]
plot for [i=1:4] rows("stadium", word(engines, i), "$3 == " . stadium) using 5:9 with linespoints ls i title word(names, i), \
     "<echo 1.5e9,180.34" using 1:2 with points lc rgb "#cc79a7" pt 3 ps 1.2 lw 2 title "the paper: 180.34 s"

set output "memory.svg"
set title "bust, " . bust . " facets"
set ylabel "peak memory, bytes"
set xrange [5e4:2e12]
set yrange [1e6:1e10]
plot for [i=1:4] rows("bust", word(engines, i), "$3 == " . bust) using 5:10 with linespoints ls i title word(names, i), \
     x ** (2. / 3) with lines ls 5 title "computed: a plane", \
     x with lines ls 5 dt (2,3) title "computed: the grid"
