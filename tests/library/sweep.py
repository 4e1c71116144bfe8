"""The same as sweep.c through Python."""
import sys

import numpy
import teracell


def most():
    """The most memory that this process ever had, in bytes."""
    with open("/proc/self/status") as status:
        return next(1024 * int(line.split()[1]) for line in status if line.startswith("VmHWM:"))


edge = int(sys.argv[2]) if len(sys.argv) > 2 else 256
threads = int(sys.argv[3]) if len(sys.argv) > 3 else 0
array = numpy.ones((edge, edge, edge), numpy.uint8)
numpy.count_nonzero(array)
before = most()

grid = teracell.open(sys.argv[1])
boxes = solid = 0
for z in range(0, grid.shape[0], edge):
    for y in range(0, grid.shape[1], edge):
        for x in range(0, grid.shape[2], edge):
            box = (z, y, x, z + edge, y + edge, x + edge)
            if grid.uniform(box) is not None:
                continue
            grid.read(box, out=array, threads=threads)
            boxes += 1
            solid += numpy.count_nonzero(array)
print(f"{boxes} boxes, {solid} solid cells, {(most() - before) / 1e6:.1f} MB beside the array")
