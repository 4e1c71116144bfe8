/* Builds the forest of p4est that has the leaves which it reads: "M nx ny nz", the roots along each axis, then "level i j k" for each leaf. Succeeds
 * if the forest has these leaves and no others, in this order where there is one root, and p4est calls it balanced, also over corners. */
#include <p8est.h>
#include <p8est_bits.h>
#include <p8est_connectivity.h>
#include <p8est_extended.h>

typedef struct {
  long long first[3]; /* level-0 cell */
  int level;
} leaf_t;

static leaf_t* leaves;
static size_t count;
static int coarsest;
static long long roots[3];

static int by_place(const void* a, const void* b) {
  for (int d = 2; d >= 0; --d) {
    const long long x = ((const leaf_t*)a)->first[d], y = ((const leaf_t*)b)->first[d];
    if (x != y) return x < y ? -1 : 1;
  }
  return 0;
}

static leaf_t of_quadrant(p8est_t* forest, p4est_topidx_t tree, const p8est_quadrant_t* q) {
  double corner[3];
  leaf_t out;
  p8est_qcoord_to_vertex(forest->connectivity, tree, q->x, q->y, q->z, corner);
  for (int d = 0; d < 3; ++d) out.first[d] = (long long)(corner[d] * (double)(1LL << coarsest) + 0.5);
  out.level = coarsest - q->level;
  return out;
}

static int is_coarser(p8est_t* forest, p4est_topidx_t tree, p8est_quadrant_t* q) {
  const leaf_t wanted = of_quadrant(forest, tree, q);
  const leaf_t* found = bsearch(&wanted, leaves, count, sizeof *leaves, by_place);
  return found != NULL && found->level < wanted.level;
}

int main(int argc, char** argv) {
  size_t room = 1024, matched = 0;
  long long cell[3];
  sc_MPI_Init(&argc, &argv);
  sc_init(sc_MPI_COMM_WORLD, 0, 0, NULL, SC_LP_ERROR);
  p4est_init(NULL, SC_LP_ERROR);
  if (scanf("%d %lld %lld %lld", &coarsest, &roots[0], &roots[1], &roots[2]) != 4) return 2;
  leaves = malloc(room * sizeof *leaves);
  for (leaf_t l; scanf("%d %lld %lld %lld", &l.level, &cell[0], &cell[1], &cell[2]) == 4; ++count) {
    for (int d = 0; d < 3; ++d) l.first[d] = cell[d] << l.level;
    if (count == room) leaves = realloc(leaves, (room *= 2) * sizeof *leaves);
    leaves[count] = l;
  }
  leaf_t* in_order = malloc(count * sizeof *leaves);
  memcpy(in_order, leaves, count * sizeof *leaves);
  qsort(leaves, count, sizeof *leaves, by_place);

  p8est_connectivity_t* shape = p8est_connectivity_new_brick((int)roots[0], (int)roots[1], (int)roots[2], 0, 0, 0);
  p8est_t* forest = p8est_new_ext(sc_MPI_COMM_WORLD, shape, 0, 0, 1, 0, NULL, NULL);
  p8est_refine(forest, 1, is_coarser, NULL);
  for (p4est_topidx_t t = forest->first_local_tree; t <= forest->last_local_tree; ++t) {
    p8est_tree_t* tree = p8est_tree_array_index(forest->trees, t);
    for (size_t i = 0; i < tree->quadrants.elem_count; ++i, ++matched) {
      const leaf_t q = of_quadrant(forest, t, p8est_quadrant_array_index(&tree->quadrants, i));
      const leaf_t* found = bsearch(&q, leaves, count, sizeof *leaves, by_place);
      if (found == NULL || found->level != q.level) return 3;
      if (roots[0] * roots[1] * roots[2] == 1 && by_place(&in_order[i], &q) != 0) return 4;
    }
  }
  if (matched != count) return 5;
  if (!p8est_is_balanced(forest, P8EST_CONNECT_FULL)) return 6;
  printf("%zu leaves\n", matched);
  p8est_destroy(forest);
  p8est_connectivity_destroy(shape);
  sc_finalize();
  return sc_MPI_Finalize();
}
