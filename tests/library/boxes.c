/* Reads boxes: a line "LEVEL BYTES OUTSIDE x0 y0 z0 x1 y1 z1" of stdin gives the elements of the box, [z][y][x], on stdout. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <teracell.h>

int main(int argc, char** argv) {
  tc_grid* grid;
  if (argc != 2 || tc_open(argv[1], &grid) != TC_OK) return fprintf(stderr, "%s\n", tc_error()), 1;
  int level, bytes;
  uint32_t outside;
  int64_t lo[3], hi[3];
  while (scanf("%d %d %" SCNu32 " %" SCNd64 " %" SCNd64 " %" SCNd64 " %" SCNd64 " %" SCNd64 " %" SCNd64, &level, &bytes, &outside, &lo[0], &lo[1],
               &lo[2], &hi[0], &hi[1], &hi[2]) == 9) {
    const int64_t nx = hi[0] - lo[0], ny = hi[1] - lo[1], nz = hi[2] - lo[2], stride[3] = {1, nx, nx * ny};
    void* data = malloc((size_t)(nx * ny * nz * bytes) + 1);
    if (tc_read_box(grid, level, lo, hi, bytes, data, stride, outside, NULL, 0, 2) != TC_OK) return fprintf(stderr, "%s\n", tc_error()), 1;
    fwrite(data, (size_t)bytes, (size_t)(nx * ny * nz), stdout);
    free(data);
  }
  tc_close(grid);
  return 0;
}
