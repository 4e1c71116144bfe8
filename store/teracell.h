/* teracell: reads the cells of .tcell grids. The C++, Fortran and Python libraries stand on these functions.
 *
 * A grid has nx x ny x nz cells, each with a material. Level 0 has all cells; level L has ceil(n / 2^L) along each axis, and a cell of
 * it stands for the materials of all cells below it. Boxes are half open, lo <= cell < hi, in cells of a level, in the order x, y, z.
 * They may reach outside the grid.
 *
 * Functions that return int return TC_OK, or the kind of an error. tc_error() then has its message, for the thread that called. Nothing
 * prints, aborts or ends the process. Arguments are checked; pointers must be valid. After an error the content of output memory is
 * unspecified, and everything else is as before. Any number of threads may use a grid at the same time, except for tc_close().
 *
 * Within a major version, functions and constants may be added, and structures may get more members at their end; nothing else changes.
 * So a function that fills structures of the caller takes the size of one as the caller's compiler knows it, for example
 * sizeof(tc_cells): an older program gets what it has memory for, and what a newer program knows beyond this library is 0. This
 * costs less than a function for each member, and needs no member that the caller must set. Numbers that stand for one of
 * several constants are plain int: an enum type has no fixed size, and holding another value in one is undefined in C++. */
#ifndef TERACELL_H
#define TERACELL_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define TC_API __attribute__((visibility("default")))
#else
#define TC_API
#endif

#define TC_VERSION_MAJOR 0
#define TC_VERSION_MINOR 1
#define TC_VERSION_PATCH 0

enum {
  TC_OK = 0,
  TC_USAGE = 1,    /* an argument is wrong: out of range, or a value that does not fit its type */
  TC_IO = 2,       /* the operating system reports a failure */
  TC_FORMAT = 3,   /* the file is not what it should be, or is damaged */
  TC_MEMORY = 4,   /* there is not enough memory */
  TC_STOPPED = 5,  /* a function of the caller asked to stop */
  TC_INTERNAL = 6  /* anything else: an error of this library */
};

/* The version of the library that runs, as "0.1.0". TC_VERSION_* are those of this header. */
TC_API const char* tc_version(void);

/* The message of the last error of the calling thread, or "". It is valid until this thread's next call of a function of this library. */
TC_API const char* tc_error(void);

/* The errno of the last error of the calling thread, if it was TC_IO and the number is known; otherwise 0. */
TC_API int tc_errno(void);

/* ---- Grids ---- */

typedef struct tc_grid tc_grid;

/* Opens a file. This reads kilobytes, however large the grid is. The file must not change while it is open; a new file under the same
 * name is another grid. */
TC_API int tc_open(const char* path, tc_grid** grid);

/* How to read from an address: a grid may lie at https://host/g.tcell or s3://bucket/key. NULL and 0 stand for the defaults. */
typedef struct tc_source {
  const char* cache_dir;     /* a folder that keeps what is read, for the next time; default: none */
  uint64_t cache_dir_bytes;  /* how much it keeps; default: 2^30 */
  const char* endpoint;      /* the address of the store of s3:// addresses; default: that of Amazon */
  int allow_http;            /* not 0: also from http:// addresses of other machines */
} tc_source;

/* Opens a file or an address. tc_open() does the same with the defaults. Requests to s3:// addresses are signed if the environment holds a
 * key: AWS_ACCESS_KEY_ID, AWS_SECRET_ACCESS_KEY, AWS_SESSION_TOKEN, AWS_REGION. If the object is replaced while the grid is open, functions
 * return TC_IO: cells of two versions are never mixed. `size` is sizeof *source; `source` may be NULL. */
TC_API int tc_open_source(const char* path, const tc_source* source, size_t size, tc_grid** grid);

/* Returns the same grid for a second owner, who calls tc_close() as well: the last of them frees it. NULL gives NULL. */
TC_API tc_grid* tc_share(tc_grid* grid);

/* Frees a grid, unless other owners are left. NULL is allowed. REQUIRES: no other thread uses it for this owner. */
TC_API void tc_close(tc_grid* grid);

/* Levels are 0 to tc_levels() - 1. The last one has a single cell. */
TC_API int tc_levels(const tc_grid* grid);

/* The axis of the rays: 0, 1 or 2 for x, y, z. Neighbours along it are cheapest to read. */
TC_API int tc_ray_axis(const tc_grid* grid);

/* The unit of all lengths: "m", "mm" ... Valid until tc_close(). */
TC_API const char* tc_units(const tc_grid* grid);

/* 32 hexadecimal digits that stand for the whole content of the file, whatever its name is. Valid until tc_close(). */
TC_API const char* tc_hash(const tc_grid* grid);

/* All that is known of the grid, with the report of the run that made it, as the JSON that `teracell info --json` prints. Valid until
 * tc_close(). */
TC_API int tc_info(const tc_grid* grid, const char** json);

/* Cells of a level along x, y and z. */
TC_API int tc_shape(const tc_grid* grid, int level, int64_t cells[3]);

/* Planes between the cells of a level along an axis: out[i] = plane first + i, for i < count. Plane k is the lower side of cell k; there
 * is one more plane than there are cells. */
TC_API int tc_planes(const tc_grid* grid, int level, int axis, int64_t first, int64_t count, double* out);

/* Sample points of the cells of a level along an axis: out[i] is that of cell first + i, for i < count. That of a coarse cell is the
 * middle between those of its first and its last cell of level 0. */
TC_API int tc_samples(const tc_grid* grid, int level, int axis, int64_t first, int64_t count, double* out);

typedef struct tc_material {
  const char* name;  /* UTF-8; valid until tc_close() */
  uint8_t color[4];  /* red, green, blue, alpha */
  uint32_t rank;     /* 0 is the strongest; no two are equal. Material 0, the background, is the weakest. */
} tc_material;

/* How many materials the grid has. Their ids are 0 to this number - 1. */
TC_API int64_t tc_material_count(const tc_grid* grid);

/* out[i] = the material with the id first + i, for i < count. `size` is sizeof *out. */
TC_API int tc_materials(const tc_grid* grid, int64_t first, int64_t count, tc_material* out, size_t size);

/* ---- Cells ---- */

/* The type of the elements of an array: their size in bytes. */
enum { TC_U8 = 1, TC_U16 = 2, TC_U32 = 4 };

/* Writes the cells of a box to memory: cell (x, y, z) as an element of `type` (TC_U8 ...) at index
 *   (x - lo[0]) * stride[0] + (y - lo[1]) * stride[1] + (z - lo[2]) * stride[2]
 * of `data`. With nx = hi[0] - lo[0] and so on, {1, nx, nx * ny} is an array [z][y][x] in C, or a(nx, ny, nz) in Fortran. Strides may be
 * negative. The value of a cell is the id of its material, on a coarse level that of the strongest one; with `map` it is map[id], and
 * `map_size` must be at least the number of materials. Cells outside the grid get `outside`. If `outside`, or the value of any material of
 * the grid, does not fit the type, that is an error before anything is written. `map` may be NULL. `threads`: how many may work, 0 for one
 * per core that the thread may run on (take 1 where each core has a rank of MPI). Elements must be aligned and distinct. */
TC_API int tc_read_box(const tc_grid* grid, int level, const int64_t lo[3], const int64_t hi[3], int type, void* data,
                       const int64_t stride[3], uint32_t outside, const uint32_t* map, int64_t map_size, int threads);

/* The same for every step-th cell along each axis: cell (first[0] + i * step[0], ...) at index i * stride[0] + j * stride[1] + k *
 * stride[2], for i < count[0] and so on. What lies between is not read. Steps are at least 1. */
TC_API int tc_read_lattice(const tc_grid* grid, int level, const int64_t first[3], const int64_t count[3], const int64_t step[3],
                           int type, void* data, const int64_t stride[3], uint32_t outside, const uint32_t* map, int64_t map_size,
                           int threads);

/* Cells in a row along tc_ray_axis() with the same materials. Only the library makes these. */
typedef struct tc_run {
  int64_t start[3];           /* the first cell */
  int64_t length;             /* cells */
  uint32_t material;          /* the strongest one */
  uint32_t count;             /* of `materials`: 1 on level 0 */
  const uint32_t* materials;  /* the ids of all, ascending; valid during the call only */
} tc_run;

/* Calls visit(user, run) for the runs of a box, without expanding any cells, until it returns something other than 0; that is TC_STOPPED.
 * The part of the box outside the grid is left out. Runs come in no particular order, and a run may come in several parts. */
TC_API int tc_runs(const tc_grid* grid, int level, const int64_t lo[3], const int64_t hi[3], int (*visit)(void* user, const tc_run* run),
                   void* user);

typedef struct tc_column_run {
  int64_t from, to; /* half open */
  uint32_t material;
} tc_column_run;

/* The cells `from` to `to` (half open; cut to the grid) of the column of level 0 along an axis through (a, b), its indices along the other
 * two axes in the order x, y, z. Neighbouring runs differ. Writes the first `capacity` runs, and the number of all to `count`.
 * `size` is sizeof *runs. */
TC_API int tc_column(const tc_grid* grid, int axis, int64_t a, int64_t b, int64_t from, int64_t to, tc_column_run* runs, size_t size,
                     int64_t capacity, int64_t* count);

typedef struct tc_cells {
  uint64_t cells;          /* their number, modulo 2^64 ... */
  uint64_t cells_high;     /* ... and divided by 2^64 */
  double volume;           /* in cubic units of length */
  int64_t lo[3], hi[3];    /* the box that holds them; empty if there are none */
} tc_cells;

/* Exact counts of the cells of level 0 in a box, by material id: `count` must be the number of materials. `size` is
 * sizeof *by_material. The part of the box outside the grid is left out. Cells are not expanded. */
TC_API int tc_stats(const tc_grid* grid, const int64_t lo[3], const int64_t hi[3], tc_cells* by_material, size_t size, int64_t count);

/* Whether all cells of a box have the same value as in tc_read_box(), and which. The part of the box outside the grid is
 * left out, and what is left must not be empty. If the cells differ, `material` is not changed. */
TC_API int tc_uniform(const tc_grid* grid, int level, const int64_t lo[3], const int64_t hi[3], int* uniform, uint32_t* material);

/* ---- What mixed cells are made of ---- */

/* Writes the share of a material, from 0 to 1, in each cell of a box of level 0 to the index of `data` that tc_read_box() would take. Shares
 * are counted over the sub-samples of `mesh --fractions`: those of a cell add up to 1, and are 0 and 1 where the cell is not mixed. Cells
 * outside the grid get `outside`. `threads` as in tc_read_box(). TC_USAGE if the grid has no fractions: tc_info() lists its channels. */
TC_API int tc_fractions(const tc_grid* grid, uint32_t material, const int64_t lo[3], const int64_t hi[3], double* data, const int64_t stride[3],
                        double outside, int threads);

/* ---- Where the surface lies between cells ---- */

/* Between a cell of level 0 and its upper neighbour along an axis, which have different labels. Going from the sample point of the cell to that
 * of its neighbour, in 65536ths of that distance: from `end` on the point may not have the label of the cell, from `begin` on all points have the
 * label of the neighbour. 1 <= end <= begin <= 65536; they are equal where one wall lies there; both are 0 where surfaces don't tell (a sheet
 * that is not crossed there, a thin part that was kept). Only the library makes these. */
typedef struct tc_link {
  int64_t cell[3];
  uint32_t end, begin;
  int64_t patch; /* its number; -1 if none is known */
} tc_link;

/* A part of the boundary: what the mesh files call a group, an object or a solid; what closes a body; or a side of the domain. */
typedef struct tc_patch {
  const char* name; /* UTF-8; valid until tc_close() */
  const char* body; /* empty for a side of the domain; valid until tc_close() */
  double area;      /* in square units of length */
} tc_patch;

/* How many patches the grid has. They are numbered from 0: xmin, xmax, ymin, ymax, zmin, zmax, then those of the surfaces. 0 if the file was
 * written before files had them. */
TC_API int64_t tc_patch_count(const tc_grid* grid);

/* out[i] = the patch with the number first + i, for i < count. `size` is sizeof *out. */
TC_API int tc_patches(const tc_grid* grid, int64_t first, int64_t count, tc_patch* out, size_t size);

/* Calls visit(user, link) for the links along an axis (0, 1, 2 for x, y, z) whose cells lie in a box, until it returns something other than
 * 0; that is TC_STOPPED. The part of the box outside the grid is left out. Links come in no particular order. TC_USAGE if the grid was
 * meshed without `--links`: tc_info() lists its channels. */
TC_API int tc_links(const tc_grid* grid, int axis, const int64_t lo[3], const int64_t hi[3], int (*visit)(void* user, const tc_link* link),
                    void* user);

/* ---- Refined grids ---- */

/* A leaf of an octree over the cells of level 0: a cell of a level, where the grid is no finer than that. Only the library makes these. */
typedef struct tc_leaf {
  int64_t cell[3];   /* of its level; a leaf at an upper side of the grid may reach beyond it */
  int32_t level;
  uint32_t material; /* of the level-0 cell at its first one + floor(2^(level - 1)) on each axis, or the grid's last */
} tc_leaf;

/* Calls visit(user, leaf) for the leaves that have a cell in a box of level 0, in the order of the Morton codes of their first cells (bits of x,
 * y, z in turn, x lowest), until it returns something other than 0; that is TC_STOPPED. Leaves are of level 0 at interfaces, which are faces
 * between cells of different labels, and at most of level `coarsest` (0 to 16); of each level there are at least `layers` cells (1 to 100)
 * around what is finer. Leaves that touch, also over edges and corners, differ by at most one level. `want` says what is to be of which level:
 * "interface=L,material:NAME=L,patch:NAME=L,inside:NAME=L,box:X0,Y0,Z0,X1,Y1,Z1=L", each of it any number of times; NULL: interface=0. What
 * the leaves are depends on the whole grid, not on the box, of which the part outside the grid is left out. `threads` as in tc_read_box().
 * Temporary files are made in the folder that TMPDIR names, or /tmp. */
TC_API int tc_leaves(const tc_grid* grid, const int64_t lo[3], const int64_t hi[3], int coarsest, int layers, const char* want, int threads,
                     int (*visit)(void* user, const tc_leaf* leaf), void* user);

/* ---- Who computes what ---- */

/* A file that `teracell partition` has written. Threads may share it. */
typedef struct tc_partition tc_partition;

/* What holds for all parts. The texts are valid until tc_partition_close(). */
typedef struct tc_plan {
  int64_t ranks;          /* parts, which are numbered from 0 */
  int64_t cells[3];       /* of the grid */
  int64_t align;          /* cuts lie at multiples of so many cells */
  int64_t halo;           /* cells around each part */
  double total;           /* the work in the whole grid */
  const char* method;     /* "blocks" or "slabs" */
  const char* grid_hash;  /* tc_hash() of the grid that was cut: compare it with that of the grid that you read */
} tc_plan;

typedef struct tc_part {
  int64_t lo[3], hi[3];           /* the cells of level 0 that the rank computes */
  int64_t halo_lo[3], halo_hi[3]; /* those that it reads: with the halo, clipped to the grid */
  double weight;                  /* the work in it */
  const int64_t* neighbours;      /* ranks, ascending; valid until tc_partition_close() */
  int64_t count;                  /* of the neighbours */
} tc_part;

TC_API int tc_partition_open(const char* path, tc_partition** partition);
TC_API void tc_partition_close(tc_partition* partition); /* NULL is allowed */
/* `size` is sizeof *plan, or sizeof *part. */
TC_API int tc_partition_plan(const tc_partition* partition, tc_plan* plan, size_t size);
TC_API int tc_partition_part(const tc_partition* partition, int64_t rank, tc_part* part, size_t size);

/* ---- Stopping ---- */

/* A function and its argument. This structure never grows: it is handed over by value. */
typedef struct tc_watcher {
  int (*watch)(void* user); /* NULL: nobody is asked */
  void* user;
} tc_watcher;

/* From now on, calls of the calling thread ask watcher.watch(watcher.user) now and then, and stop when it returns something other than 0;
 * that is TC_STOPPED. Returns the former watcher, so that a library can put it back. `watch` must not call this library: a call from it is
 * TC_USAGE. */
TC_API tc_watcher tc_watch(tc_watcher watcher);

#ifdef __cplusplus
}
#endif
#endif
