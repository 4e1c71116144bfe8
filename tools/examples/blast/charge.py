"""The charge of the stadium, which is also burst in open air: 10 t of TNT as a sphere of gas. And spheres as surfaces."""
import math

TNT_MASS, VOLUME = 10e3, 116.0  # kg, m^3
RADIUS = (VOLUME * 3 / 4 / math.pi) ** (1 / 3)


def sphere_obj(radius, centre=(0, 0, 0), around=96):
    """A sphere, as polygons."""
    x, y, z = centre
    rings = around // 2
    lines = ["v %r %r %r" % (x, y, z - radius), "v %r %r %r" % (x, y, z + radius)]
    for i in range(1, rings):
        polar = math.pi * i / rings
        for k in range(around):
            turn = 2 * math.pi * k / around
            across = radius * math.sin(polar)
            lines.append("v %r %r %r" % (x + across * math.cos(turn), y + across * math.sin(turn), z - radius * math.cos(polar)))
    at = lambda ring, k: 3 + (ring - 1) * around + k % around  # noqa: E731
    for k in range(around):
        lines += [f"f 1 {at(1, k + 1)} {at(1, k)}", f"f 2 {at(rings - 1, k)} {at(rings - 1, k + 1)}"]
        lines += [f"f {at(i, k)} {at(i, k + 1)} {at(i + 1, k + 1)} {at(i + 1, k)}" for i in range(1, rings - 1)]
    return "\n".join(lines) + "\n"
