"""What a key selects of an array of cells, by NumPy's rules, and how to read no more than that.

`read(first, step, out)` fills an array [z][y][x] from a lattice of cells. Whole numbers and slices are one lattice. Lists are read stretch by
stretch, or as the box around them, whichever costs less; and so are those points, as masks and several lists select them, that lie together.
NumPy then puts what was read in its place, by a key of the same kind.
"""
import itertools
import math
import operator

import numpy

from ._arguments import shown

READ = 2048  # cells that could be read in the time that it takes to ask for any: 4 us
FEW = 1 << 26  # cells that may be read at once though they are more than WASTE times as many as are selected
WASTE = 4


def select(key, shape, read, empty):
    """The cells that a key selects. `empty(shape)` makes an array of them."""
    parts = _checked(_whole(key, len(shape)), shape)
    of_axes = [part for part in parts if part is not None and part is not Ellipsis]
    arrays = [d for d, part in enumerate(of_axes) if isinstance(part, numpy.ndarray)]
    lattice = [_ascending(part) for part in of_axes]
    if arrays:
        try:
            of_axes = dict(zip(arrays, numpy.broadcast_arrays(*(of_axes[d] for d in arrays))))
        except ValueError:
            shapes = " ".join(str(of_axes[d].shape) for d in arrays)
            raise IndexError(f"shape mismatch: indexing arrays could not be broadcast together with shapes {shapes}") from None
        found = _points(of_axes, lattice, read, empty)
        spread = of_axes[arrays[0]].shape
        places = iter([numpy.arange(math.prod(spread)).reshape(spread)] + [numpy.zeros(spread, int)] * (len(arrays) - 1))
    else:
        found = _lattices(lattice, read, empty)
    back = []
    for part in parts:
        if part is None or part is Ellipsis:
            back.append(part)
        elif isinstance(part, range):
            back.append(slice(None, None, -1 if part.step < 0 else 1))
        else:
            back.append(next(places) if isinstance(part, numpy.ndarray) else 0)
    return found[tuple(back)]


def orthogonal(key, shape, read, empty):
    """The cells of a key with a part for each axis, where each list selects along its own axis."""
    parts = _checked(key, shape)
    found = _lattices([numpy.unique(part) if isinstance(part, numpy.ndarray) else _ascending(part) for part in parts], read, empty)
    for d, part in reversed(list(enumerate(parts))):
        if isinstance(part, numpy.ndarray):
            found = found.take(numpy.searchsorted(numpy.unique(part), part), d)
        elif isinstance(part, range):
            found = numpy.flip(found, d) if part.step < 0 else found
        else:
            found = found.take(0, d)
    return found


def index_of(part, n, axis):
    """A whole number of a key."""
    try:
        if isinstance(part, bool) or getattr(part, "dtype", None) == bool or getattr(part, "ndim", 0) != 0:
            raise TypeError
        i = operator.index(part)
    except TypeError:
        raise IndexError("only whole numbers, slices (':'), ellipsis ('...'), None, and arrays of whole numbers or booleans are valid indices") from None
    if not -n <= i < n:
        raise IndexError(f"index {shown(i)} is out of bounds for axis {axis} with size {n}")
    return i % n


def _whole(key, ndim):
    """A key as a list with a part for each axis, or several, None where an axis is added, and an ellipsis where it stands for none: it keeps lists apart."""
    key = [_as_array(part) for part in (key if isinstance(key, tuple) else (key,))]
    if sum(part is Ellipsis for part in key) > 1:
        raise IndexError("an index can only have a single ellipsis ('...')")
    given = sum(_axes(part) for part in key)
    if given > ndim:
        raise IndexError(f"too many indices: the array has {ndim} axes, but {given} were indexed")
    at = next((i for i, part in enumerate(key) if part is Ellipsis), len(key))
    return key[:at] + ([slice(None)] * (ndim - given) or key[at:at + 1]) + key[at + 1:]


def _as_array(part):
    """Lists and arrays as arrays; anything else as it is."""
    if not (hasattr(part, "__len__") or hasattr(part, "__array__")) or isinstance(part, (str, bytes)):
        return part
    try:
        found = numpy.asarray(part)
    except ValueError:  # lists of different lengths
        raise IndexError(f"expected a list of whole numbers or booleans, found {shown(part)}") from None
    if found.size == 0 and not hasattr(part, "dtype"):
        found = found.astype(numpy.intp)
    return found if found.ndim else part


def _axes(part):
    """How many axes of the array a part is for."""
    if part is None or part is Ellipsis:
        return 0
    return part.ndim if isinstance(part, numpy.ndarray) and part.dtype == bool else 1


def _checked(parts, shape):
    """The parts of a whole key as None, an ellipsis, whole numbers, ranges, and arrays of whole numbers from 0."""
    out, axis = [], 0
    for part in parts:
        if isinstance(part, numpy.ndarray) and part.dtype == bool:
            for d, n in enumerate(part.shape, axis):
                if n != shape[d]:
                    raise IndexError(f"boolean index did not match indexed array along axis {d}; size of axis is {shape[d]} but size of boolean axis is {n}")
            out += part.nonzero()
        elif isinstance(part, numpy.ndarray):
            out.append(_indices_of(part, shape[axis], axis))
        elif isinstance(part, slice):
            out.append(range(shape[axis])[part])
        else:
            out.append(part if part is None or part is Ellipsis else index_of(part, shape[axis], axis))
        axis += _axes(part)
    return out


def _indices_of(part, n, axis):
    if part.dtype.kind not in "iu":
        raise IndexError("arrays used as indices must be of whole numbers or booleans")
    if part.size and not (-n <= int(part.min()) and int(part.max()) < n):
        wrong = int(part.max()) if int(part.max()) >= n else int(part.min())
        raise IndexError(f"index {wrong} is out of bounds for axis {axis} with size {n}")
    part = part.astype(numpy.int64)
    return numpy.where(part < 0, part + n, part)


def _ascending(part):
    """The cells along an axis that a whole number or a slice selects."""
    if isinstance(part, range):
        return part if part.step > 0 else part[::-1]
    return part if isinstance(part, numpy.ndarray) else range(part, part + 1)


def _stretches(along):
    """Ascending cells along an axis as a list of (place in the array, range)."""
    if isinstance(along, range):
        return [(0, along)]
    steps = numpy.diff(along)
    if len(steps) and (steps == steps[0]).all():
        return [(0, range(int(along[0]), int(along[-1]) + 1, int(steps[0])))]
    starts = [0, *(numpy.flatnonzero(steps != 1) + 1).tolist()]
    ends = starts[1:] + [len(along)]
    return [(a, range(int(along[a]), int(along[b - 1]) + 1)) for a, b in zip(starts, ends)]


def _way(along):
    """What it costs to read the cells at these places along each axis, in cells, and whether the box around them is to be read."""
    cells, box, reads = (math.prod(map(count, along)) for count in (len, lambda a: len(_around(a)), lambda a: len(_stretches(a))))
    by_stretches, by_box = READ * reads + cells, READ + box
    return (by_box, True) if by_box < by_stretches and box <= max(FEW, WASTE * cells) else (by_stretches, False)


def _around(along):
    """The range that holds ascending cells along an axis."""
    return along if isinstance(along, range) else range(int(along[0]), int(along[-1]) + 1)


def _lattices(along, read, empty):
    """The cells whose places along each axis are given, in ascending order."""
    counts = [len(cells) for cells in along]
    if 0 in counts:
        return empty(counts)
    if not all(isinstance(cells, range) for cells in along) and _way(along)[1]:
        return _lattices(list(map(_around, along)), read, empty)[numpy.ix_(*(range(len(a)) if isinstance(a, range) else a - a[0] for a in along))]
    out = empty(counts)
    for parts in itertools.product(*map(_stretches, along)):
        to = out[tuple(slice(at, at + len(cells)) for at, cells in parts)]
        read([cells.start for _, cells in parts], [cells.step if len(cells) > 1 else 1 for _, cells in parts], to)
    return out


def _points(arrays, lattice, read, empty):
    """The cells at points, whose places along some axes are in `arrays`, by axis: an array that has the points along the first of these axes, one
    cell along the others of them, and the cells of the lattice along the rest."""
    axes = list(arrays) + [d for d in range(len(lattice)) if d not in arrays]  # those of the points first
    rest = [lattice[d] for d in axes[len(arrays):]]
    width = math.prod(map(len, rest))
    points = [array.ravel() for array in arrays.values()]
    out = empty([len(points[0])] + [len(cells) for cells in rest])

    def fill(some, bits):
        """Reads the points with these numbers at once, or block by block, whose edges have 2**bits cells."""
        around = [range(int(p[some].min()), int(p[some].max()) + 1) for p in points]
        if dense := math.prod(map(len, around)) <= WASTE * len(some):
            places = [(box, p[some] - box.start) for box, p in zip(around, points)]
        else:
            places = [numpy.unique(p[some], return_inverse=True) for p in points]
        along = [found for found, _ in places] + rest
        cells = math.prod(map(len, along))
        if dense or (cells <= max(FEW, WASTE * len(some) * width) and _way(along)[0] <= (READ + width) * len(some)):
            by_axis = dict(zip(axes, along))
            box = _lattices([by_axis[d] for d in range(len(lattice))], read, empty)
            out[some] = box.transpose(axes)[tuple(inverse for _, inverse in places)]
            return
        blocks = numpy.stack([p[some] >> bits for p in points])
        order = numpy.lexsort(blocks)
        ends = numpy.flatnonzero((numpy.diff(blocks[:, order]) != 0).any(axis=0)) + 1
        for block in numpy.split(some[order], ends):
            fill(block, max(0, bits - 2))

    if out.size:
        fill(numpy.arange(len(points[0])), 6)
    shape = [len(points[0])] + [1] * (len(arrays) - 1) + [len(cells) for cells in rest]
    return out.reshape(shape).transpose(numpy.argsort(axes))
