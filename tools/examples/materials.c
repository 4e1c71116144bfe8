/* Prints how many cells of each material a grid has, and draws its middle slice.
 *
 *   cc materials.c $(pkg-config --cflags --libs teracell) -o materials && ./materials stadium.tcell */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <teracell.h>

static void check(int status) {
  if (status == TC_OK) return;
  fprintf(stderr, "materials: %s\n", tc_error());
  exit(1);
}

int main(int argc, char** argv) {
  if (argc != 2) {
    fprintf(stderr, "usage: materials GRID.tcell\n");
    return 2;
  }
  tc_grid* grid;
  check(tc_open(argv[1], &grid));

  int64_t n[3];
  const int64_t count = tc_material_count(grid);
  tc_material* materials = malloc((size_t)count * sizeof *materials);
  check(tc_shape(grid, 0, n));
  check(tc_materials(grid, 0, count, materials, sizeof *materials));
  printf("%" PRId64 " x %" PRId64 " x %" PRId64 " cells\n", n[0], n[1], n[2]);

  tc_cells* cells = malloc((size_t)count * sizeof *cells);
  check(tc_stats(grid, (int64_t[3]){0, 0, 0}, n, cells, sizeof *cells, count));
  for (int64_t i = 0; i < count; ++i)
    printf("%-16s %" PRIu64 " cells, %g %s^3\n", materials[i].name, cells[i].cells, cells[i].volume, tc_units(grid));
  free(cells);
  free(materials);

  /* The finest level that is at most 72 cells wide. */
  int level = 0;
  while (level + 1 < tc_levels(grid) && n[0] > 72) check(tc_shape(grid, ++level, n));
  uint8_t* slice = malloc((size_t)(n[0] * n[2]));
  const int64_t lo[3] = {0, n[1] / 2, 0}, hi[3] = {n[0], n[1] / 2 + 1, n[2]}, stride[3] = {1, 0, n[0]};
  check(tc_read_box(grid, level, lo, hi, TC_U8, slice, stride, 0, NULL, 0, 0));
  for (int64_t z = n[2]; z-- > 0; putchar('\n'))
    for (int64_t x = 0; x < n[0]; ++x) putchar(".#o*+%@&="[slice[z * n[0] + x] % 9]);
  free(slice);
  tc_close(grid);
  return 0;
}
