"""Checks of arguments: what is wrong is said here, in the words of the library, before _native is asked."""
import operator
import os
import re

from ._errors import UsageError

FARTHEST = 1 << 53  # cells; the library takes no farther ones


def shown(value):
    """A value in a message: short, whatever it is."""
    try:
        text = repr(value)
    except Exception:  # a number of very many digits, for one
        text = f"a value of the type {type(value).__name__}"
    return text if len(text) <= 80 else text[:77] + "..."


def whole(name, value, least=-FARTHEST, most=FARTHEST):
    """A whole number in a range."""
    try:
        found = operator.index(value)
    except TypeError:
        raise UsageError(f"{name}: expected a whole number, found {shown(value)}") from None
    if not least <= found <= most:
        raise UsageError(f"{name}: expected {least} to {most}, found {shown(found)}")
    return found


def wholes(name, values, count, least=-FARTHEST, or_one=""):
    """A list of so many whole numbers."""
    try:
        found = list(values)
    except TypeError:
        found = []
    if len(found) != count:
        raise UsageError(f"{name}: expected {or_one}{count} whole numbers, found {shown(values)}")
    return [whole(name, value, least) for value in found]


def one_or_three(name, values, least):
    """A whole number or a list of three, as such."""
    if hasattr(values, "__index__") and not getattr(values, "ndim", 0):
        return whole(name, values, least)
    return wholes(name, values, 3, least, "one or ")


def selectors(want):
    """What is wanted of a refined grid, as text: of a dict, KIND:NAME=LEVEL,KIND:NAME=LEVEL ..."""
    if want is None or isinstance(want, str):
        return want or ""
    if not hasattr(want, "items"):
        raise UsageError(f"want: expected a text or a dict, found {shown(want)}")
    out = []
    for key, level in want.items():
        kind, colon, name = str(key).partition(":")
        if kind != "box" and any(c in name for c in ',="'):
            name = '"' + name.replace('"', '""') + '"'
        out.append(f"{kind}{colon}{name}={whole(f'want of {shown(key)}', level, 0, 16)}")
    return ",".join(out)


def corners(box):
    """The corners (z0, y0, x0) and (z1, y1, x1) of a box."""
    found = wholes("box", box, 6)
    return found[:3], found[3:]


def path_of(path):
    """A path as text. os.fsencode() gives its bytes, whatever they are."""
    text = os.fsdecode(path)
    if "\0" in text:
        raise UsageError(f"expected a path without NUL characters, found {shown(path)}")
    return text


def is_address(path):
    """Whether a path begins with a scheme, as https:// does."""
    return re.match(r"[A-Za-z][A-Za-z0-9+.-]*://", path) is not None
