#!/usr/bin/python3
"""Counts the cells of each material that touch another one, block by block with a halo, in constant memory.

    python3 surface_cells.py stadium.tcell
"""
import sys

import numpy
import teracell

if len(sys.argv) != 2:
    sys.exit("usage: surface_cells.py GRID.tcell")
BLOCK = 128
grid = teracell.open(sys.argv[1])
outside = len(grid.materials)  # no material has this id
touching = numpy.zeros(len(grid.materials), numpy.int64)
for z in range(0, grid.shape[0], BLOCK):
    for y in range(0, grid.shape[1], BLOCK):
        for x in range(0, grid.shape[2], BLOCK):
            box = (z, y, x, *(min(lo + BLOCK, n) for lo, n in zip((z, y, x), grid.shape)))
            if grid.uniform([max(0, i - 1) for i in box[:3]] + [min(i + 1, n) for i, n in zip(box[3:], grid.shape)]) is not None:
                continue
            cells = grid.read(box, halo=1, outside=outside)
            inner = cells[1:-1, 1:-1, 1:-1]
            differs = numpy.zeros(inner.shape, bool)
            for neighbour in (cells[:-2, 1:-1, 1:-1], cells[2:, 1:-1, 1:-1], cells[1:-1, :-2, 1:-1], cells[1:-1, 2:, 1:-1],
                              cells[1:-1, 1:-1, :-2], cells[1:-1, 1:-1, 2:]):
                differs |= (neighbour != inner) & (neighbour != outside)
            touching += numpy.bincount(inner[differs], minlength=len(touching))
for material in grid.materials:
    print(f"{material.name:16} {touching[material.id]}")
