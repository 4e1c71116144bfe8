/* Reads the cells of a grid box by box, those that hold a surface, and prints the memory that this takes beside the array.
 *
 *   sweep GRID.tcell [EDGE [THREADS]] */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <teracell.h>

/* The most memory that this process ever had, in kB. */
static long most(void) {
  char line[256];
  long kb = 0;
  FILE* status = fopen("/proc/self/status", "r");
  while (status && fgets(line, sizeof line, status))
    if (sscanf(line, "VmHWM: %ld", &kb) == 1) break;
  if (status) fclose(status);
  return kb;
}

static void check(int status) {
  if (status == TC_OK) return;
  fprintf(stderr, "sweep: %s\n", tc_error());
  exit(1);
}

int main(int argc, char** argv) {
  const int64_t edge = argc > 2 ? atoll(argv[2]) : 256, stride[3] = {1, edge, edge * edge}, cells = edge * edge * edge;
  const int threads = argc > 3 ? atoi(argv[3]) : 0;
  uint8_t* array = malloc((size_t)cells);
  memset(array, 1, (size_t)cells);
  const long before = most();

  tc_grid* grid;
  int64_t n[3], lo[3], boxes = 0, solid = 0;
  check(tc_open(argc > 1 ? argv[1] : "", &grid));
  check(tc_shape(grid, 0, n));
  for (lo[2] = 0; lo[2] < n[2]; lo[2] += edge)
    for (lo[1] = 0; lo[1] < n[1]; lo[1] += edge)
      for (lo[0] = 0; lo[0] < n[0]; lo[0] += edge) {
        const int64_t hi[3] = {lo[0] + edge, lo[1] + edge, lo[2] + edge};
        int uniform;
        uint32_t material;
        check(tc_uniform(grid, 0, lo, hi, &uniform, &material));
        if (uniform) continue;
        check(tc_read_box(grid, 0, lo, hi, TC_U8, array, stride, 0, NULL, 0, threads));
        ++boxes;
        for (int64_t i = 0; i < cells; ++i) solid += array[i] != 0;
      }
  tc_close(grid);
  free(array);
  printf("%" PRId64 " boxes, %" PRId64 " solid cells, %.1f MB beside the array\n", boxes, solid, (double)(most() - before) * 1024 / 1e6);
  return 0;
}
