"""A grid as a notebook shows it: a table of facts, and a slice through the middle along each axis, from a level that is coarse enough to be quick."""
import base64
import html
import struct
import zlib

import numpy

MOST_CELLS = 256  # along the longest axis of the level
MOST_MATERIALS = 40
EDGE = 180  # of the largest picture, in pixels of the page


def page_of(level, coarser):
    """The HTML of a level, which is the first of a list that goes on with all coarser ones."""
    size = [axis.planes[-1] - axis.planes[0] for axis in level.axes]
    facts = [("file", level.path),
             ("cells", f"{' × '.join(f'{n:,}' for n in level.shape[::-1])} = {level.size:,} (x × y × z)"),
             ("array", f"{level.shape} (z, y, x), {level.dtype}, {level.nbytes:,} bytes"),
             ("size", " × ".join(f"{length:g}" for length in size[::-1]) + f" {level.units}"),
             ("level", f"{level.number} of 0 to {coarser[-1].number}"),
             ("hash", level._native.hash())]
    rows = "".join(f"<tr><th style='text-align:left'>{name}</th><td style='text-align:left'>{html.escape(text)}</td></tr>" for name, text in facts)
    names = " ".join(map(_material, level.materials[:MOST_MATERIALS]))
    if len(level.materials) > MOST_MATERIALS:
        names += f" … {len(level.materials):,} in all"
    rows += f"<tr><th style='text-align:left'>materials</th><td style='text-align:left'>{names}</td></tr>"
    pictures = "".join(_pictures(next(c for c in coarser if max(c.shape) <= MOST_CELLS), size))
    return f"<div><table>{rows}</table>{pictures}</div>"


def png(colors):
    """The bytes of a picture [row][column][red, green, blue, alpha] of uint8."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows, columns, _ = colors.shape
    lines = numpy.zeros((rows, 1 + 4 * columns), numpy.uint8)  # each begins with 0: no filter
    lines[:, 1:] = colors.reshape(rows, -1)
    head = struct.pack(">IIBBBBB", columns, rows, 8, 6, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(lines.tobytes())) + chunk(b"IEND", b"")


def _material(m):
    red, green, blue, alpha = m.color
    return ("<span style='white-space:nowrap'><span style='display:inline-block;width:.8em;height:.8em;border:1px solid #888;"
            f"background:rgba({red},{green},{blue},{alpha / 255:g})'></span> {html.escape(m.name)}</span>")


def _pictures(level, size):
    colors = numpy.array([m.color for m in level.materials], numpy.uint8)
    for d in range(3):
        middle = level.shape[d] // 2
        labels = level[tuple(middle if axis == d else slice(None) for axis in range(3))][::-1]  # up is up
        height, width = (max(1, round(EDGE * length / max(size))) for axis, length in enumerate(size) if axis != d)
        caption = f"{'zyx'[d]} = {level.axes[d].samples[middle]:g} {level.units}"
        data = base64.b64encode(png(colors[labels])).decode()
        yield ("<figure style='display:inline-block;margin:6px;text-align:center'>"
               f"<img alt='{html.escape(caption)}' style='width:{width}px;height:{height}px;image-rendering:pixelated;border:1px solid #888' "
               f"src='data:image/png;base64,{data}'><figcaption>{html.escape(caption)}</figcaption></figure>")

