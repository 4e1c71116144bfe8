"""teracell: Cartesian grids of any number of cells from CAD surfaces, as NumPy arrays.

    >>> import teracell
    >>> g = teracell.open("stadium.tcell")
    >>> g.shape                               # z, y, x
    (220, 770, 1000)
    >>> g[100, :, ::4]                        # ids of materials, read from the file
    >>> g.read((0, 0, 0, 64, 64, 64), halo=1, outside=0)
    >>> g.level(3)[...]                       # the whole grid, eight times coarser
    >>> g[:64, :64, :64] == g.materials["steel"].id
    >>> g.close()                             # or: with teracell.open("stadium.tcell") as g: ...

Arrays have the axes z, y, x, and so have boxes: (z0, y0, x0, z1, y1, x1), half open, in cells of the level. The cells of a level
never exist as a whole: an index reads what it selects, and dask and xarray read block by block.
"""
import collections.abc
import json
import math
import operator
import os

import numpy

from . import _html, _native
from ._arguments import corners, is_address, one_or_three, path_of, selectors, shown, whole, wholes
from ._errors import Error, FormatError, IoError, TooLargeError, UsageError
from ._indices import index_of, orthogonal, select
from ._materials import Material, Materials

__all__ = ["open", "mesh", "planes", "info", "Planes", "Grid", "Level", "Axis", "Material", "Materials", "Patch", "Cells", "Partition", "Part",
           "Error", "FormatError", "IoError", "TooLargeError", "UsageError", "__version__"]
__version__ = _native.version

Axis = collections.namedtuple("Axis", "name planes samples")
Axis.__doc__ = """An axis of a level: its planes (cells + 1) and the sample points of its cells (cells), as float64."""
Patch = collections.namedtuple("Patch", "number name body area")
Patch.__doc__ = """A part of the boundary: its number, its name, its body ("" for a side of the domain) and its area in square units."""

Cells = collections.namedtuple("Cells", "cells volume box")
Cells.__doc__ = """Exact counts of a material: the number of cells, their volume, and the box that holds them, or None if there are none."""

Planes = collections.namedtuple("Planes", "x y z breaches warnings")
Planes.__doc__ = """The planes between the cells along x, y and z (cells + 1), as float64; the places where two rules collide, as dicts with the keys
axis, rule ("finest", "width" or "growth"), at, found and expected; and warnings, such as faces that have no plane."""

Part = collections.namedtuple("Part", "rank box halo_box weight neighbours")
Part.__doc__ = """What a rank computes: its box of level 0, the box that it reads (with the halo, clipped to the grid), the work in it, and the
ranks next to it."""


def open(path, *, cache_dir=None, cache_dir_size=None, endpoint=None, allow_http=False):
    """Opens a .tcell file and returns its Grid. This reads kilobytes, however large the grid is. `with open(...) as g:` closes it at the end.

    The path may be an address, https://host/g.tcell or s3://bucket/key. Then `cache_dir` is a folder that keeps what is read, up to
    `cache_dir_size` bytes; `endpoint` is the address of the store of s3:// addresses, if it is not Amazon's; `allow_http` allows http://
    addresses of other machines. AWS_ACCESS_KEY_ID and the other usual variables hold the key that signs requests to s3:// addresses.
    """
    return Grid(path, cache_dir, cache_dir_size, endpoint, allow_http)


_MEMORY = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")


class _File:
    """The open file that a grid and its levels share. `native` is None once it is closed: calls that are on their way then end as they would have."""

    def __init__(self, path, folder, size, endpoint, allow_http):
        self.native = _native.Grid(os.fsencode(path), os.fsencode(folder or ""), size or 0, os.fsencode(endpoint or ""), allow_http)
        self._geometry = None

    def geometry(self, native):
        """Of level 0, in the order x, y, z: where it begins, and what is known of its axes."""
        self._geometry = self._geometry or json.loads(native.info())["grid"]
        return self._geometry


class Level:
    """The cells of one level as an array [z][y][x] of material ids, uint8, or uint16 where there are more than 256 materials.

    On a level above 0 a cell has the strongest of the materials below it. Threads may share a level.

    Comparing it with a number, a material or its name gives an array of booleans, as with NumPy: `level == "steel"`. Levels of more cells
    than the machine has memory are compared box by box, `level[box] == 1`, or lazily, `level.dask() == 1`.
    """

    def __init__(self, grid, level):
        self._file, self.path, self._opened = grid._file, grid.path, grid._opened
        self.materials = grid.materials
        self.number = whole("level", level, 0, self._native.levels() - 1)
        self.shape = tuple(self._native.shape(self.number))[::-1]
        self.dtype = numpy.dtype(numpy.uint8 if len(self.materials) <= 256 else numpy.uint16)

    ndim = 3

    @property
    def _native(self):
        native = self._file.native
        if native is None:
            raise UsageError(f"{self.path}: the grid is closed: open it again")
        return native

    @property
    def size(self):
        return math.prod(self.shape)

    @property
    def nbytes(self):
        """The bytes that the cells would take as an array."""
        return self.size * self.dtype.itemsize

    @property
    def axes(self):
        """The axes z, y, x of this level."""
        return tuple(Axis(name, self._native.planes(self.number, d), self._native.samples(self.number, d)) for d, name in ((2, "z"), (1, "y"), (0, "x")))

    @property
    def units(self):
        """The unit of lengths: "m", "mm" ..."""
        return self._native.units()

    @property
    def origin(self):
        """The lower corner of the grid, (z, y, x): the first planes of the axes."""
        return tuple(self._file.geometry(self._native)["min"][::-1])

    @property
    def spacing(self):
        """The edges of a cell, (z, y, x). On levels above 0 the last cell of an axis may be shorter. A grid with a graded axis has none, which is
        a UsageError: its planes are in `axes`."""
        axes = self._file.geometry(self._native)["axes"]
        for name, axis in zip("xyz", axes):
            if axis["type"] != "uniform":
                raise UsageError(f"spacing: the cells along {name} differ in width: see the planes in `axes`")
        return tuple(axis["step"] * 2**self.number for axis in axes[::-1])

    def __repr__(self):
        return f"<teracell level {self.number} of {self.path!r}: {' x '.join(map(str, self.shape))} cells (z, y, x), {self.dtype}>"

    def _repr_html_(self):
        return _html.page_of(self, [Level(self, n) for n in range(self.number, self._native.levels())])

    def __len__(self):
        return self.shape[0]

    def __array__(self, dtype=None, copy=None):
        if copy is False:  # as NumPy 2 wants to be told
            raise UsageError("copy: expected None or True, because reading a grid makes an array, found False")
        return self[...] if dtype is None else self[...].astype(dtype, copy=False)

    def __reduce__(self):
        return _level_of, (self._opened, self._native.hash(), self.number)

    def __dask_tokenize__(self):
        return "teracell", self._native.hash(), self.number

    def __getitem__(self, key):
        """Indexing as in NumPy: whole numbers, slices with any step, Ellipsis, None, lists and arrays of whole numbers, and masks. Two lists select
        points; numpy.ix_() makes a lattice of them. Only what is selected is read."""
        return self._select(key, 0)

    def _select(self, key, threads):
        return select(key, self.shape, self._reader(threads), self._empty)

    def _orthogonal(self, key):
        return orthogonal(key, self.shape, self._reader(0), self._empty)

    def _reader(self, threads):
        native = self._native
        return lambda first, step, out: native.read(self.number, first[::-1], step[::-1], out, 0, None, threads)

    def _empty(self, shape, dtype=None):
        dtype = numpy.dtype(dtype or self.dtype)
        bytes = math.prod(shape) * dtype.itemsize
        if bytes > _MEMORY:
            raise TooLargeError(f"{self.path}: expected an array that fits into the {_MEMORY:,} bytes of memory, found one of {bytes:,}: select a box, "
                                "g[z0:z1, y0:y1, x0:x1], take a coarser level, g.level(3), or blocks, g.dask(); g.stats() counts cells")
        return numpy.empty(shape, dtype)

    def _compare(self, other, how):
        if isinstance(other, (str, Material)):
            other = self.materials.id_of(other)
        if isinstance(other, Level):
            other = other[...]
        if numpy.ndim(other):
            return how(self[...], other)
        of_ids = numpy.asarray(how(numpy.arange(len(self.materials)), other), numpy.uint32)
        out = self._empty(self.shape, bool)
        self._native.read(self.number, [0, 0, 0], [1, 1, 1], out.view(numpy.uint8), 0, of_ids, 0)
        return out

    def __eq__(self, other):
        return self._compare(other, operator.eq)

    def __ne__(self, other):
        return self._compare(other, operator.ne)

    def __lt__(self, other):
        return NotImplemented if isinstance(other, str) else self._compare(other, operator.lt)

    def __le__(self, other):
        return NotImplemented if isinstance(other, str) else self._compare(other, operator.le)

    def __gt__(self, other):
        return NotImplemented if isinstance(other, str) else self._compare(other, operator.gt)

    def __ge__(self, other):
        return NotImplemented if isinstance(other, str) else self._compare(other, operator.ge)

    __hash__ = object.__hash__  # a grid is a key of a dict, as the object that it is

    def read(self, box, halo=0, out=None, outside=0, map=None, order="C", threads=0):
        """Reads a box (z0, y0, x0, z1, y1, x1), which may reach outside the grid, and returns it as an array [z][y][x].

        halo     cells more on each side: one number, or one for each of z, y, x
        out      the array to fill, of any strides and of a type of 1, 2 or 4 bytes; otherwise a new one is made
        outside  the value of cells outside the grid
        map      the value of each material: a list by id, or a dict by id or name that names all of them
        order    "C" or "F", of a new array
        threads  how many may read; 0 is one per core

        A value that does not fit the type of `out` is a UsageError, and nothing is written.
        """
        lo, hi = corners(box)
        halo = one_or_three("halo", halo, 0)
        halo = halo if isinstance(halo, list) else [halo] * 3
        outside = whole("outside", outside, 0, (1 << 32) - 1)
        threads = whole("threads", threads, 0, 1024)
        if order not in ("C", "F"):
            raise UsageError(f"order: expected 'C' or 'F', found {shown(order)}")
        shape = [max(0, hi[d] - lo[d] + 2 * halo[d]) for d in range(3)]
        lo = [lo[d] - halo[d] for d in range(3)]
        values = self._values(map)
        if out is None:
            most = max(outside, int(values.max()) if values is not None else len(self.materials) - 1)
            out = numpy.empty(shape, numpy.min_scalar_type(most) if values is not None or outside else self.dtype, order)
        elif not isinstance(out, numpy.ndarray):
            raise UsageError(f"out: expected an array of NumPy, found {shown(out)}")
        elif list(out.shape) != shape:
            raise UsageError(f"out: expected an array of the shape {tuple(shape)}, found {out.shape}")
        if not out.flags.writeable:
            raise UsageError("out: expected an array that may be written, found one that is read-only")
        if not out.flags.aligned:
            raise UsageError("out: expected an array whose items are aligned")
        if out.dtype.kind not in "ui" or out.dtype.itemsize > 4 or not out.dtype.isnative:
            raise UsageError(f"out: expected integers of 1, 2 or 4 bytes in the machine's order, found {out.dtype}")
        if outside > numpy.iinfo(out.dtype).max:
            raise UsageError(f"outside: expected 0 to {numpy.iinfo(out.dtype).max}, which {out.dtype} holds, found {outside}")
        if out.dtype.kind == "i":
            most = int(values.max()) if values is not None else len(self.materials) - 1
            if most > numpy.iinfo(out.dtype).max:
                raise UsageError(f"out: expected a type that holds {most}, found {out.dtype}")
        self._native.read(self.number, lo[::-1], [1, 1, 1], out, outside, values, threads)
        return out

    def runs(self, box=None):
        """The runs of a box as an array of rows z, y, x, length, material: `length` cells from (z, y, x) along the grid's rays."""
        lo, hi = self._box(box)
        return self._native.runs(self.number, lo[::-1], hi[::-1])[:, [2, 1, 0, 3, 4]]

    def uniform(self, box=None):
        """The id of the material of all cells of a box, or None if they differ."""
        lo, hi = self._box(box)
        return self._native.uniform(self.number, lo[::-1], hi[::-1])

    def dask(self, chunks="auto"):
        """A dask array that reads each of its blocks when it is needed."""
        import dask.array

        return dask.array.from_array(_Blocks(self), chunks=chunks, asarray=False, lock=False)

    def xarray(self, chunks="auto"):
        """An xarray.DataArray with coordinates, over dask()."""
        import xarray

        from .xarray import attributes, coordinates

        return xarray.DataArray(self.dask(chunks), coordinates(self), ("z", "y", "x"), "material", attributes(self))

    def _box(self, box):
        return corners((0, 0, 0) + self.shape if box is None else box)

    def _values(self, map):
        if map is None:
            return None
        if isinstance(map, dict):
            values = [None] * len(self.materials)
            for key, value in map.items():
                id = self.materials.id_of(key) if isinstance(key, (str, Material)) and key in self.materials else key
                if not isinstance(id, (int, numpy.integer)) or not 0 <= id < len(values):
                    raise UsageError(f"map: the grid has no material {shown(key)}")
                values[id] = value
            missing = [m.name for m in self.materials if values[m.id] is None]
            if missing:
                raise UsageError(f"map: expected a value for each material, found none for {missing[0]!r}")
            map = values
        values = numpy.asarray(map)
        if values.ndim != 1 or values.dtype.kind not in "ui" or len(values) < len(self.materials) or values.min() < 0 or values.max() >= 1 << 32:
            raise UsageError(f"map: expected {len(self.materials)} whole numbers from 0 to {(1 << 32) - 1}")
        return numpy.ascontiguousarray(values, numpy.uint32)


class _Blocks:
    """A level for dask, whose tasks run in threads of their own: each reads with one."""

    ndim = 3

    def __init__(self, level):
        self._level, self.shape, self.dtype = level, level.shape, level.dtype

    def __dask_tokenize__(self):
        return self._level.__dask_tokenize__()

    def __getitem__(self, key):
        return self._level._select(key, 1)


class Grid(Level):
    """A .tcell file. It is the array of its level 0; level(L) is a coarser one. `with` closes it."""

    def __init__(self, path, cache_dir=None, cache_dir_size=None, endpoint=None, allow_http=False):
        # Pickles and dask's workers may have another folder.
        self.path = path_of(path) if is_address(path_of(path)) else os.path.abspath(path_of(path))
        folder = _given(cache_dir, lambda name: os.path.abspath(path_of(name)))
        size = 0 if cache_dir_size is None else whole("cache_dir_size", cache_dir_size, 1)
        self._opened = self.path, folder, size or None, endpoint, bool(allow_http)
        self._file = _File(*self._opened)
        self.materials = Materials(Material(i, *m) for i, m in enumerate(self._file.native.materials()))
        super().__init__(self, 0)

    def close(self):
        """Closes the file, for the levels of the grid, too; afterwards their cells can't be read. Closing it again does nothing."""
        self._file.native = None

    @property
    def closed(self):
        return self._file.native is None

    def __enter__(self):
        self._native  # raises if it is closed
        return self

    def __exit__(self, *_):
        self.close()

    def __reduce__(self):
        return _grid_of, (self._opened, None if self.closed else self.hash)

    def __repr__(self):
        state = "closed" if self.closed else f"{self.levels} levels"
        return f"<teracell grid {self.path!r}: {' x '.join(map(str, self.shape))} cells (z, y, x), {len(self.materials)} materials, {state}>"

    @property
    def levels(self):
        """The number of levels. The last one has a single cell."""
        return self._native.levels()

    @property
    def hash(self):
        """32 hexadecimal digits that stand for the whole content of the file, whatever its name is."""
        return self._native.hash()

    @property
    def ray_axis(self):
        """The axis of `shape` that the rays run along: cells that are neighbours along it are the cheapest to read."""
        return 2 - self._native.ray_axis()

    @property
    def info(self):
        """All that is known of the grid, with the report of the run that made it, as `teracell info --json` prints it."""
        return json.loads(self._native.info())

    def fractions(self, material, box=None, outside=0.0, threads=0):
        """The share of a material, from 0 to 1, in each cell of a box (z0, y0, x0, z1, y1, x1) of level 0, as an array [z][y][x] of float64.

        material  its id, its name, or a Material
        outside   the value of cells outside the grid
        threads   how many may read; 0 is one per core

        Shares are counted over the sub-samples of `mesh --fractions`: those of a cell add up to 1, and are 0 and 1 where the cell is not
        mixed. A grid without fractions is a UsageError.
        """
        lo, hi = self._box(box)
        threads = whole("threads", threads, 0, 1024)
        material = self.materials.id_of(material)
        out = numpy.empty([max(0, hi[d] - lo[d]) for d in range(3)], numpy.float64)
        if out.size:
            self._native.fractions(material, lo[::-1], out, float(outside), threads)
        return out

    @property
    def patches(self):
        """The parts of the boundary by number, as a list of Patch: the sides of the domain (xmin, xmax, ymin ...), then those of the surfaces:
        groups, objects and solids that mesh files name, and what closes a body. Empty for files of earlier versions."""
        return [Patch(i, *p) for i, p in enumerate(self._native.patches())]

    def links(self, box=None, axis="x"):
        """The links between the cells of a box (z0, y0, x0, z1, y1, x1) of level 0 and their upper neighbours along an axis, where these have
        different labels: arrays (cells, end, begin, patch), in the order of the cells.

        axis    "x", "y" or "z"
        cells   [n][3], int64: z, y, x
        end     [n], uint32: going from the cell's sample point to its neighbour's, in 65536ths of the distance, where the label of the cell
                ends ...
        begin   [n], uint32: ... and from where on there is only that of its neighbour. They are equal where one wall lies there, and
                1 <= end <= begin <= 65536. Both are 0 where surfaces don't tell: beside cells that are kept because of thin parts, and beside
                those of a sheet that is not crossed between the two sample points.
        patch   [n], int64: its number in `patches`; -1 if none is known. Where both are 0 it is that of the body, if it has just one.

        A grid that was meshed without links is a UsageError.
        """
        if axis not in ("x", "y", "z"):
            raise UsageError(f"axis: expected 'x', 'y' or 'z', found {shown(axis)}")
        lo, hi = self._box(box)
        cells, end, begin, patch = self._native.links("xyz".index(axis), lo[::-1], hi[::-1])
        cells = cells[:, ::-1]
        order = numpy.lexsort(cells.T[::-1])
        return cells[order], end[order], begin[order], patch[order]

    def leaves(self, box=None, coarsest=8, layers=2, *, want=None, threads=0):
        """The leaves of an octree over the cells of level 0 that have a cell in a box (z0, y0, x0, z1, y1, x1), in Morton order: a structured array
        with the fields level (int32), i, j, k (int64: the cell along x, y, z, at the leaf's level) and label (uint32: the id of its material).

        coarsest  the coarsest level, 0 to 16
        layers    how many cells of each level lie around what is finer, 1 to 100
        want      what is to be of which level, as text or as a dict: {"interface": 1, "material:steel": 0, "patch:inlet": 0, "inside:air": 3,
                  "box:0,0,0,8,8,8": 2}. Without it, what lies at an interface between two labels is of level 0.
        threads   how many may work; 0: one per core

        A leaf of level L covers 2**L cells along each axis, as far as the grid goes. Leaves that touch differ by at most one level.
        """
        lo, hi = self._box(box)
        dtype = [("level", "<i4"), ("i", "<i8"), ("j", "<i8"), ("k", "<i8"), ("label", "<u4")]
        coarsest, layers = whole("coarsest", coarsest, 0, 16), whole("layers", layers, 1, 100)
        return numpy.frombuffer(self._native.leaves(lo[::-1], hi[::-1], coarsest, layers, selectors(want), whole("threads", threads, 0, 1024)), dtype)

    def level(self, number):
        """A level: 0 has all cells, each further one half as many along every axis, rounded up."""
        return Level(self, number)

    def stats(self, box=None):
        """Exact counts of level 0 in a box: a list of Cells, by material id. No cells are expanded."""
        lo, hi = self._box(box)
        return [Cells(cells, volume, tuple(a[::-1]) + tuple(b[::-1]) if cells else None) for cells, volume, a, b in self._native.stats(lo[::-1], hi[::-1])]

    def column(self, axis, at):
        """The column of level 0 along an axis ("z", "y", "x", or 0, 1, 2 of `shape`) through the cell `at` of the other two, in the
        order of `shape`: rows from, to (half open), material."""
        if isinstance(axis, str) and axis not in tuple("zyx"):
            raise UsageError(f"axis: expected 'z', 'y', 'x' or 0, 1, 2, found {shown(axis)}")
        d = "zyx".index(axis) if isinstance(axis, str) else whole("axis", axis, 0, 2)
        high, low = wholes("at", at, 2)
        return self._native.column(2 - d, low, high)


class Partition(collections.abc.Sequence):
    """A file that `teracell partition` has written: partition[rank] is the Part of a rank. Boxes are (z0, y0, x0, z1, y1, x1).

    cells      (nz, ny, nx) of the grid
    align      cuts lie at multiples of so many cells
    halo       cells around each part
    total      the work in the whole grid
    method     "blocks" or "slabs"
    grid_hash  the `hash` of the grid that was cut: compare it with that of the grid that you read
    """

    def __init__(self, path):
        self.path = os.path.abspath(path_of(path))
        self._native = _native.Partition(os.fsencode(self.path))
        self._ranks, cells, self.align, self.halo, self.total, self.method, self.grid_hash = self._native.plan()
        self.cells = tuple(cells)[::-1]

    def __reduce__(self):
        return Partition, (self.path,)

    def __repr__(self):
        return f"<teracell partition {self.path!r}: {self._ranks} ranks, {self.method}>"

    def __len__(self):
        return self._ranks

    def __getitem__(self, rank):
        if isinstance(rank, slice):
            return [self[i] for i in range(self._ranks)[rank]]
        rank = index_of(rank, self._ranks, 0)
        lo, hi, halo_lo, halo_hi, weight, neighbours = self._native.part(rank)
        return Part(rank, tuple(lo[::-1] + hi[::-1]), tuple(halo_lo[::-1] + halo_hi[::-1]), weight, neighbours)


def info(path):
    """What a file holds, as a dict: of a grid `Grid.info`; of a surface or an assembly its format, unit, box and parts, as
    `teracell info --json` prints them, lengths in the unit of the file."""
    name = path_of(path)
    if not is_address(name) and not name.endswith(".tcell"):
        if _bytes_of(name, 16)[8:16] != b"teracell":
            return json.loads(_native.survey(os.fsencode(name)))["files"][0]
    return Grid(name).info


def mesh(scene, output, *, folder=".", units=None, by_part=False, cells=None, step=None, pad=None, axis=None, engine=None, threads=0, memory=None, tmp=None, thin=False,
         fractions=None, links=False, resume=False, deflection=None, angle=None, face_patches=False, cad_memory=None, cad_seconds=None, progress=None):
    """Meshes a scene and returns the Grid. The file appears under the name `output` only when it is complete.

    scene     a scene file; a surface or an assembly, or a list of these; or a scene as a dict, whose paths are relative to `folder`
    units     of the grid, without a scene (default: the first unit that a file states, else "m")
    by_part   without a scene: a body and a material for each part of the files
    cells     the number of cells along the longest axis, or of each axis (x, y, z)
    step      the edge of a cell, instead of `cells`
    pad       cells around the bodies
    axis      "x", "y" or "z": the axis of the rays (the cells are the same)
    memory    bytes that the run may take (default: a quarter of the machine's); larger surfaces are spilled to `tmp`
    fractions keep the shares of materials in cells that a boundary cuts, counted over so many sub-samples per cell along (x, y, z)
    links     keep where labels change between neighbouring sample points
    deflection, angle  of STEP files: the largest distance between a surface and its facets, a length in the units of the grid or cells ("0.1c", the
              default), and the largest angle between neighbouring chords in degrees (12)
    face_patches  of STEP files: the faces of a part that have a colour of their own are patches
    cad_memory, cad_seconds  bytes and seconds that the CAD kernel may take for a STEP file
    progress  a function that is called with the phase and the share of it that is done; what it raises ends the run

    The report of the run is the attribute `report` of the grid that is returned.
    """
    if axis is not None and axis not in ("x", "y", "z"):
        raise UsageError(f"axis: expected 'x', 'y' or 'z', found {shown(axis)}")
    if progress is not None and not callable(progress):
        raise UsageError(f"progress: expected a function, found {shown(progress)}")
    text, base, surfaces = "", path_of(folder), []
    if isinstance(scene, (list, tuple)):
        surfaces = [os.fsencode(path_of(s)) for s in scene]
    elif isinstance(scene, dict) or path_of(scene).endswith(".json"):
        text, base = _scene_of(scene, base)
    else:
        surfaces = [os.fsencode(path_of(scene))]
    if isinstance(scene, (list, tuple)) and not surfaces:
        raise UsageError("scene: expected at least one surface, found none")
    if not surfaces and (units is not None or by_part):
        raise UsageError("units, by_part: expected surfaces without a scene, found a scene")
    options = {"units": _given(units, str), "by_part": bool(by_part), "cells": _given(cells, lambda n: one_or_three("cells", n, 1)), "step": _given(step, _length),
               "pad": _given(pad, lambda n: whole("pad", n, 0)), "axis": _given(axis, "xyz".index), "engine": _given(engine, str),
               "threads": whole("threads", threads, 0, 1024), "memory": _given(memory, lambda n: whole("memory", n, 1, (1 << 63) - 1)),
               "tmp": _given(tmp, lambda path: os.fsencode(path_of(path))), "thin": bool(thin), "links": bool(links),
               "fractions": _given(fractions, lambda n: [whole("fractions", m, 1, 256) for m in wholes("fractions", n, 3)]), "resume": bool(resume),
               "deflection": _given(deflection, str), "angle": _given(angle, lambda a: _length(a, "angle")), "face_patches": bool(face_patches),
               "cad_memory": _given(cad_memory, lambda n: whole("cad_memory", n, 1, (1 << 63) - 1)), "cad_seconds": _given(cad_seconds, lambda s: _length(s, "cad_seconds"))}
    report = _native.mesh(text, os.fsencode(base), surfaces, os.fsencode(path_of(output)), options, progress)
    grid = Grid(output)
    grid.report = json.loads(report)
    return grid


def planes(scene, *, folder="."):
    """The planes that meshing a scene would have, as Planes, without meshing it: its surfaces are read once.

    scene     a scene file; or a scene as a dict, whose paths are relative to `folder`
    """
    text, place = (json.dumps(scene), path_of(folder)) if isinstance(scene, dict) else ("", path_of(scene))
    axes, breaches, warnings = _native.planes(text, os.fsencode(place))
    return Planes(*(numpy.array(axis) for axis in axes), json.loads(breaches), warnings)


def _scene_of(scene, folder):
    """A scene's text and the folder of its paths."""
    if isinstance(scene, dict):
        return json.dumps(scene), folder
    return _bytes_of(path_of(scene)), os.path.dirname(path_of(scene))


def _bytes_of(path, most=-1):
    """The first bytes of a file."""
    try:
        with _open(path, "rb") as file:
            return file.read(most)
    except OSError as e:
        raise IoError(e.errno, f"{path}: can't open: {e.strerror}") from e


_open = __builtins__["open"] if isinstance(__builtins__, dict) else __builtins__.open


def _given(value, convert):
    return None if value is None else convert(value)


def _length(value, name="step"):
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise UsageError(f"{name}: expected a number, found {shown(value)}") from None


def _grid_of(opened, hash):
    """The grid that was pickled. What is at its path may be another one by now."""
    grid = Grid(*opened)
    if hash is not None and grid.hash != hash:
        found = grid.hash
        grid.close()
        raise UsageError(f"{grid.path}: expected the grid with the hash {hash}, found {found}: it was replaced")
    return grid


def _level_of(opened, hash, number):
    return _grid_of(opened, hash).level(number)
