# Draws the pictures from points.csv, both in the folder that this is called in.
set terminal svg size 760,500 font "Helvetica,15" background "white"
set datafile separator comma
set logscale xy
set format xy "10^{%T}"
set tics nomirror
set border 3 lw 1.2
set grid xtics ytics lc rgb "#e4e4e4" lw 1
set key left top reverse Left samplen 2.5 spacing 1.15
set lmargin 9
set rmargin 3

set style line 1 lc rgb "#d55e00" lw 2 pt 5  ps 0.8  # brute
set style line 2 lc rgb "#0072b2" lw 2 pt 7  ps 0.8  # tree
set style line 3 lc rgb "#009e73" lw 2 pt 9  ps 1.0  # slice
set style line 4 lc rgb "#222222" lw 2 pt 13 ps 1.0  # scan
set style line 5 lc rgb "#909090" lw 1.5 dt (6,5)    # computed
engines = "brute tree slice scan"
names = "'brute: every facet for every ray' 'tree: ADT over the facets' 'slice: plane by plane' 'scan: the default'"

# Columns of the rows that an awk condition picks: input 1, engine 2, facets 3, n 4, cells 5, rays 6, cast 8, run 9, memory 10.
rows(input, engine, condition) = sprintf("< awk -F, '$1 == \"%s\" && $2 == \"%s\" && %s' points.csv", input, engine, condition)
# Facets and nanoseconds a ray, from what the rays of n = 2048 cost more than those of n = 512.
per_ray = "< awk -F, -v OFS=, '$1 == \"bust\" && $2 == \"%s\" {if ($4 == 512) {cast[$3] = $8; rays[$3] = $6}; if ($4 == 2048 && $3 in cast) print $3, 1e9 * ($8 - cast[$3]) / ($6 - rays[$3])}' points.csv"

casting = "CPU time of casting, s"

set output "facets-bust.svg"
set title "bust, 1024^3 cells = 10^6 rays"
set xlabel "facets"
set ylabel casting
set xrange [100:1e7]
set yrange [0.01:100]
plot for [i=1:4] rows("bust", word(engines, i), "$4 == 1024") using 3:8 with linespoints ls i title word(names, i), \
     2.1e-3 * x with lines ls 5 title "in proportion to the facets"

set output "facets-stadium.svg"
set title "stadium, 1024 x 820 x 205 cells = 1.7 10^5 rays"
set xrange [1000:1e7]
plot for [i=1:4] rows("stadium", word(engines, i), "$4 == 1024") using 3:8 with linespoints ls i title word(names, i), \
     4.6e-4 * x with lines ls 5 title "in proportion to the facets"

set output "ray.svg"
set title "bust: what 3.9 10^6 more rays cost (brute: all of its rays)"
set ylabel "CPU time a ray, ns"
set xrange [100:1e7]
set yrange [10:1e5]
plot rows("bust", "brute", "$4 == 1024") using 3:(1e9 * $8 / $6) with linespoints ls 1 title word(names, 1), \
     for [i=2:4] sprintf(per_ray, word(engines, i)) using 1:2 with linespoints ls i title word(names, i), \
     11 * log(x) / log(2) with lines ls 5 title "11 ns log_2 (facets)"

set output "cells-bust.svg"
set title "bust, 99,938 facets"
set xlabel "cells"
set ylabel casting
set xrange [1e5:1e12]
set yrange [0.001:100]
set key right bottom
guide(x) = x ** (2. / 3)
plot for [i=1:4] rows("bust", word(engines, i), "$3 == 99938") using 5:8 with linespoints ls i title word(names, i), \
     1.1e-7 * guide(x) with lines ls 5 title "in proportion to cells^{2/3}"

set output "cells-stadium.svg"
set title "stadium, 189,572 facets"
set ylabel "CPU time of the whole run, s"
set xrange [1e5:1e11]
set yrange [0.01:1000]
set key left top
plot for [i=1:4] rows("stadium", word(engines, i), "$3 == 189572") using 5:9 with linespoints ls i title word(names, i), \
     "+" using (1.5e9):(180.34) every ::0::0 with points lc rgb "#cc79a7" pt 3 ps 1.4 lw 2 title "the paper's stadium on its machine: 180.34 s"

set output "memory.svg"
set title "bust, 99,938 facets, one thread"
set ylabel "peak memory, bytes"
set xrange [1e5:1e12]
set yrange [1e6:1e10]
plot for [i=1:4] rows("bust", word(engines, i), "$3 == 99938") using 5:10 with linespoints ls i title word(names, i), \
     guide(x) with lines ls 5 title "computed: a plane of cells, a byte each", \
     x with lines ls 5 dt (2,3) title "computed: all cells, a byte each"
