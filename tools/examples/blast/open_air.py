"""The charge of the stadium in open air, where the answer is known. One eighth of the space is computed; the planes x, y, z = 0 are planes of
symmetry."""
import json
import math
import pathlib

import numpy

import charge
import foam
import gas
import radial

OPEN = ("xmax", "ymax", "zmax")
TNT_LENGTH = 44.0
TNT_GAUGES = (10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0)
DIRECTIONS = ((1, 0, 0), (1, 1, 0), (1, 1, 1))  # along an axis, and the two diagonals


def tnt(teracell, folder, cells):
    """The burst on cells^3 cells of a cube with the charge in its corner, beside the curve of Kinney and Graham."""
    folder, width = pathlib.Path(folder), TNT_LENGTH / cells
    case = foam.Case(teracell, folder, folder / "grid.tcell", open_sides=OPEN)
    (folder / "sphere.obj").write_text(charge.sphere_obj(charge.RADIUS))
    (folder / "scene.json").write_text(json.dumps({
        "units": "m", "grid": {"min": [0, 0, 0], "max": [TNT_LENGTH] * 3, "cells": [cells] * 3}, "background": "air",
        "materials": {"air": {}, "explosive": {}}, "bodies": [{"name": "charge", "mesh": "sphere.obj", "material": "explosive"}]}))
    case.log("mesh", [case.teracell, "mesh", str(folder / "scene.json"), "-o", case.grid])
    filling = gas.Charge(case.charge_volume(), charge.TNT_MASS * gas.TNT / 8, charge.TNT_MASS / 8)
    # A gauge on a plane of symmetry would lie between cells.
    places = [tuple(max(r * c / math.sqrt(sum(d)), width / 10) for c in d) for r in TNT_GAUGES for d in DIRECTIONS]
    end = 1.25 * gas.kinney_graham_arrival(TNT_GAUGES[-1], charge.TNT_MASS)
    case.run(filling, end, end, places, far=50.0)
    times, pressures = case.gauges()
    rows = []
    for i, r in enumerate(TNT_GAUGES):
        found = [arrival_and_peak(times, pressures[:, 3 * i + k]) for k in range(3)]
        arrival, peak = (sum(f[n] for f in found) / 3 for n in range(2))
        expected = float(gas.kinney_graham(r, charge.TNT_MASS)), gas.kinney_graham_arrival(r, charge.TNT_MASS)
        rows.append({"radius": r, "peak": peak, "peak_reference": expected[0], "arrival": arrival, "arrival_reference": expected[1],
                     "spread": (max(f[1] for f in found) - min(f[1] for f in found)) / peak})
    return {"cell": width, "gauges": rows}


def tnt_along_radius():
    """The same burst, computed along its radius alone: arrival and peak at each distance."""
    filling = gas.Charge(charge.VOLUME, charge.TNT_MASS * gas.TNT, charge.TNT_MASS)
    times, pressures = radial.burst(filling, charge.VOLUME, TNT_GAUGES)
    return [dict(zip(("arrival", "peak"), arrival_and_peak(times, gauge))) for gauge in pressures.T]


def arrival_and_peak(times, pressures):
    """When the overpressure has risen to half of its peak, and the peak."""
    over = pressures - gas.P0
    i = int(numpy.argmax(over > over.max() / 2))
    return float(times[i - 1] + (times[i] - times[i - 1]) * (over.max() / 2 - over[i - 1]) / (over[i] - over[i - 1])), float(over.max())
