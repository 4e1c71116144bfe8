"""Rays through a grid of cells, for pictures that need neither a display nor a graphics card. The cells that a camera sees are found once; each frame
then only colours them."""
import numpy

BLOCK = 1 << 15  # rays at a time, so that their arrays stay in the cache


class Camera:
    def __init__(self, eye, target, width, height, degrees):
        self.eye, self.width, self.height = numpy.array(eye, float), width, height
        ahead = numpy.array(target, float) - self.eye
        ahead /= numpy.linalg.norm(ahead)
        right = numpy.cross(ahead, (0, 0, 1))
        right /= numpy.linalg.norm(right)
        self.frame = right, numpy.cross(right, ahead), ahead
        self.tangent = numpy.tan(numpy.radians(degrees) / 2)  # of half of the horizontal angle

    def directions(self, samples=1):
        """Unit vectors of the rays, row by row from the top, `samples` squared of them per pixel."""
        right, up, ahead = self.frame
        u = ((numpy.arange(self.width * samples) + 0.5) / (self.width * samples) * 2 - 1) * self.tangent
        v = (1 - (numpy.arange(self.height * samples) + 0.5) / (self.height * samples) * 2) * self.tangent * self.height / self.width
        rays = ahead + u[None, :, None] * right + v[:, None, None] * up
        return (rays / numpy.linalg.norm(rays, axis=2, keepdims=True)).reshape(-1, 3).astype(numpy.float32)


class Cells:
    """Cubic cells, array [z][y][x]; those that are not 0 stop rays. `corner` is the lowest point of the first cell."""

    def __init__(self, array, corner, width):
        self.corner, self.width = numpy.array(corner, float), width
        self.size = numpy.array(array.shape[::-1])
        self.padded = numpy.full([n + 2 for n in array.shape], 255, numpy.uint8)  # a border that ends rays
        self.padded[1:-1, 1:-1, 1:-1] = array
        self.flat = self.padded.ravel()
        self.strides = numpy.array([1, self.size[0] + 2, (self.size[0] + 2) * (self.size[1] + 2)])

    def cast(self, origins, directions):
        """For each ray the distance, the axis and the material of the first cell that stops it (J. Amanatides, A. Woo: A Fast Voxel Traversal
        Algorithm for Ray Tracing, 1987). The material is 255 where nothing stops it."""
        result = [numpy.empty(len(directions), kind) for kind in (numpy.float32, numpy.int8, numpy.uint8)]
        for begin in range(0, len(directions), BLOCK):
            rays = slice(begin, begin + BLOCK)
            here = origins if origins.ndim == 1 else origins[rays]
            for all_, some in zip(result, self._cast((here - self.corner) / self.width, directions[rays].astype(float))):
                all_[rays] = some
        result[0] *= self.width
        return result

    def _cast(self, origin, direction):
        origin = numpy.broadcast_to(origin, direction.shape)
        direction = numpy.where(numpy.abs(direction) < 1e-9, 1e-9, direction)
        planes = numpy.stack([-origin / direction, (self.size - origin) / direction])
        enter, leave = planes.min(0).max(1), planes.max(0).min(1)
        distance, material = numpy.full(len(direction), numpy.inf), numpy.full(len(direction), 255, numpy.uint8)
        axis = planes.min(0).argmax(1).astype(numpy.int8)
        alive = numpy.nonzero((enter < leave) & (leave > 0))[0]
        start = numpy.maximum(enter[alive], 0)
        d = direction[alive].T
        cell = numpy.clip(numpy.floor(origin[alive].T + d * start), 0, (self.size - 1)[:, None]).astype(numpy.int32)
        step = numpy.sign(d).astype(numpy.int32)
        reach = [((cell[a] + (step[a] > 0)) - origin[alive, a]) / d[a] for a in range(3)]  # the distance at which the ray leaves the cell
        delta = [1 / numpy.abs(d[a]) for a in range(3)]
        moves = [(step[a] * self.strides[a]).astype(numpy.int32) for a in range(3)]
        at = ((cell + 1) * self.strides[:, None]).sum(0).astype(numpy.int32)
        way, entered = start, axis[alive]
        while len(alive):
            found = self.flat[at]
            stopped = found != 0
            if stopped.any():
                ended = alive[stopped]
                distance[ended], axis[ended], material[ended] = way[stopped], entered[stopped], found[stopped]
                on = ~stopped
                alive, at, way, entered = alive[on], at[on], way[on], entered[on]
                reach, delta, moves = ([x[on] for x in some] for some in (reach, delta, moves))
            along_x = (reach[0] <= reach[1]) & (reach[0] <= reach[2])
            along_y = ~along_x & (reach[1] <= reach[2])
            entered = numpy.where(along_x, 0, numpy.where(along_y, 1, 2)).astype(numpy.int8)
            way = numpy.where(along_x, reach[0], numpy.where(along_y, reach[1], reach[2]))
            at = at + numpy.where(along_x, moves[0], numpy.where(along_y, moves[1], moves[2]))
            for a, along in enumerate((along_x, along_y, ~(along_x | along_y))):
                reach[a] = reach[a] + along * delta[a]
        return distance, axis, material

    def crowding(self, radius):
        """The share of cells that stop rays, in the box of 2 radius + 1 cells about each; outside counts as free."""
        share = (self.padded[1:-1, 1:-1, 1:-1] != 0).astype(numpy.float32)
        for axis in range(3):
            total = numpy.cumsum(share, axis=axis, dtype=numpy.float32)
            n = total.shape[axis]
            high = numpy.take(total, numpy.minimum(numpy.arange(n) + radius, n - 1), axis=axis)
            low = numpy.take(total, numpy.maximum(numpy.arange(n) - radius - 1, 0), axis=axis)
            low[tuple(slice(0, radius + 1) if a == axis else slice(None) for a in range(3))] = 0
            share = (high - low) / (2 * radius + 1)
        return share

    def sample(self, values, points):
        """The values of the cells at points; those outside take the nearest."""
        i, j, k = (numpy.clip(((points[:, a] - self.corner[a]) / self.width).astype(numpy.int32), 0, self.size[a] - 1) for a in range(3))
        return values[k, j, i]
