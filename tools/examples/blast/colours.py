"""The colours of overpressure: dark at rest, then through red and yellow to white as it rises, and blue for suction. The scale is that of asinh:
linear within 5 kPa, at which windows break, and logarithmic above."""
import numpy

LINEAR, LOWEST, HIGHEST = 5e3, -80e3, 2e6  # Pa
TICKS = (-5e4, -1e4, 0, 1e4, 5e4, 2e5, 1e6)
# Where on the scale, and the colour there.
STOPS = [(-3.5, "#9fe0ff"), (-2.4, "#3f93dd"), (-1.2, "#1d5596"), (-0.4, "#163050"), (0.0, "#12151c"), (0.7, "#3b1040"), (2.0, "#8f1f5c"), (3.2, "#d8423f"), (4.4, "#f98e2b"),
         (5.6, "#fbd24e"), (6.7, "#fffbe0")]


def scale(overpressure):
    return numpy.arcsinh(overpressure / LINEAR)


def _table(entries=1024):
    at = numpy.linspace(scale(LOWEST), scale(HIGHEST), entries)
    rgb = numpy.array([[int(colour[i:i + 2], 16) / 255 for i in (1, 3, 5)] for _, colour in STOPS])
    return numpy.stack([numpy.interp(at, [s for s, _ in STOPS], rgb[:, c]) for c in range(3)], axis=1).astype(numpy.float32)


TABLE = _table()


def colour(overpressure):
    """RGB from 0 to 1."""
    low, high = scale(LOWEST), scale(HIGHEST)
    return TABLE[numpy.clip((scale(overpressure) - low) / (high - low) * (len(TABLE) - 1), 0, len(TABLE) - 1).astype(numpy.int32)]
