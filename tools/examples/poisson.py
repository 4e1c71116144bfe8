#!/usr/bin/python3
"""Solves Poisson's equation on the leaves of a refined grid, by finite volumes: fine in the bodies, coarse away from them.

    python3 poisson.py bust.tcell

The solution is known, sin(pi x) sin(pi y) sin(pi z) on the domain as a unit cube, so that the error can be told: it falls as the leaves get finer.
"""
import sys

import numpy
import scipy.sparse
import scipy.sparse.linalg
import teracell


def neighbours(leaves):
    """The pairs of leaves that share a face, which is that of the first one, with the axis."""
    cells = numpy.stack([leaves["i"], leaves["j"], leaves["k"]], 1)
    place = {(level, *cell): n for n, (level, cell) in enumerate(zip(leaves["level"].tolist(), cells.tolist()))}
    for n, (level, cell) in enumerate(zip(leaves["level"].tolist(), cells.tolist())):
        for axis in range(3):
            for step in (-1, 1):
                beside = list(cell)
                beside[axis] += step
                same = place.get((level, *beside))
                if same is not None and step > 0:
                    yield n, same, axis
                larger = place.get((level + 1, *(c >> 1 for c in beside)))
                if larger is not None:
                    yield n, larger, axis


def gradients(a, b, centre, size, values, sides):
    """Those of a leaf's value that fit its neighbours best; on the sides of the domain the value is 0."""
    matrix, right = numpy.zeros((len(values), 3, 3)), numpy.zeros((len(values), 3))
    for one, other in ((a, b), (b, a)):
        step = centre[other] - centre[one]
        numpy.add.at(matrix, one, step[:, :, None] * step[:, None, :])
        numpy.add.at(right, one, step * (values[other] - values[one])[:, None])
    for leaves, axis, step in sides:
        matrix[leaves, axis, axis] += step**2
        right[leaves, axis] -= step * values[leaves]
    return numpy.linalg.solve(matrix, right[:, :, None])[:, :, 0]


def solve(grid, finest):
    """The number of leaves, of which those in bodies are of the level `finest` and none is more than one level coarser, and the solution's error."""
    want = {f"inside:{material.name}": finest for material in grid.materials[1:]}
    leaves = grid.leaves(coarsest=finest + 1, want={"interface": finest, **want})
    cells = numpy.array(grid.shape[::-1])
    first = numpy.stack([leaves["i"], leaves["j"], leaves["k"]], 1) << leaves["level"][:, None]
    last = numpy.minimum(first + (1 << leaves["level"].astype(numpy.int64))[:, None], cells)
    size, centre, volume = (last - first) / cells, (first + last) / 2 / cells, ((last - first) / cells).prod(1)

    a, b, axis = numpy.array(list(neighbours(leaves))).T
    flux = volume[a] / size[a, axis] / ((size[a, axis] + size[b, axis]) / 2)  # for a difference of 1
    diagonal = numpy.bincount(a, flux, len(leaves)) + numpy.bincount(b, flux, len(leaves))
    sides = [(numpy.flatnonzero(at == side), d, (-1, 1)[i] * size[at == side, d] / 2)
             for d in range(3) for i, (at, side) in enumerate(((first[:, d], 0), (last[:, d], cells[d])))]
    for at_side, d, step in sides:
        diagonal[at_side] += volume[at_side] / size[at_side, d] / abs(step)
    matrix = scipy.sparse.coo_matrix((-flux, (a, b)), (len(leaves),) * 2)
    matrix = (matrix + matrix.T + scipy.sparse.diags(diagonal)).tocsr()

    exact = numpy.sin(numpy.pi * centre).prod(1)
    beside = centre[a] - centre[b]  # from the middle of a coarser leaf to the line through the face
    beside[numpy.arange(len(a)), axis] = 0
    found, missing = numpy.zeros(len(leaves)), numpy.zeros(len(a))
    for _ in range(6):  # where sizes differ, what was missing of the flux is added the next time
        right = 3 * numpy.pi**2 * exact * volume + numpy.bincount(a, missing, len(leaves)) - numpy.bincount(b, missing, len(leaves))
        found, failed = scipy.sparse.linalg.cg(matrix, right, found, M=scipy.sparse.diags(1 / diagonal))
        if failed:
            sys.exit("the solver did not converge")
        missing = flux * (gradients(a, b, centre, size, found, sides)[b] * beside).sum(1)
    return len(leaves), float(numpy.sqrt(((found - exact) ** 2 * volume).sum()))


if len(sys.argv) != 2:
    sys.exit("usage: poisson.py GRID.tcell")
with_errors = [(level, *solve(teracell.open(sys.argv[1]), level)) for level in (3, 2, 1, 0)]
for level, leaves, error in with_errors:
    print(f"bodies of level {level}: {leaves:8} leaves, error {error:.2e}")
