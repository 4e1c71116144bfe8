"""Spherical charges in open air, where the answer is known. One eighth of the space is computed; the planes x, y, z = 0 are planes of symmetry."""
import json
import math
import pathlib

import numpy

import charge
import foam
import gas
import radial

OPEN = ("xmax", "ymax", "zmax")


def octant(teracell, folder, cells, length, radius, ranks=2):
    """A cube of `length` with a spherical charge of `radius` in its corner, and the width of its cells."""
    folder = pathlib.Path(folder)
    case = foam.Case(teracell, folder, folder / "grid.tcell", open_sides=OPEN, ranks=ranks)
    (folder / "sphere.obj").write_text(charge.sphere_obj(radius))
    (folder / "scene.json").write_text(json.dumps({
        "units": "m", "grid": {"min": [0, 0, 0], "max": [length] * 3, "cells": [cells] * 3}, "background": "air",
        "materials": {"air": {}, "explosive": {}}, "bodies": [{"name": "charge", "mesh": "sphere.obj", "material": "explosive"}]}))
    case.log("mesh", [case.teracell, "mesh", str(folder / "scene.json"), "-o", case.grid])
    return case, length / cells


def totals(case, width, time):
    """Mass and energy in the octant."""
    p, rho, u = (case.field(name, time) for name in ("p", "rho", "U"))
    return width**3 * float(rho.sum()), width**3 * float(gas.energy_density(p, rho, (u * u).sum(axis=1)).sum())


def profile(case, time, width):
    """Radii, and the mean pressure of the cells about as far from the centre. The bins are as wide as a cell."""
    radius = numpy.sqrt((case.field("C", time) ** 2).sum(axis=1))
    bins = (radius / width).astype(int)
    count = numpy.maximum(numpy.bincount(bins), 1)
    return numpy.bincount(bins, radius) / count, numpy.bincount(bins, case.field("p", time)) / count


def front(radii, pressures):
    """The radius at which the pressure has risen to half of its peak, seen from ahead of the shock."""
    half = gas.P0 + (pressures.max() - gas.P0) / 2
    i = numpy.nonzero(pressures > half)[0][-1]
    return radii[i] + (radii[i + 1] - radii[i]) * (pressures[i] - half) / (pressures[i] - pressures[i + 1])


# The charge of the point blast is as small as the grid allows: three cells in radius, of air at its usual density. The shock ends at a radius
# of 1 m with a pressure of 10^4 times that of the air, which therefore does not matter.
SEDOV_RADIUS, SEDOV_LENGTH, SEDOV_CHARGE = 1.0, 1.2, 3  # m, m, cells


def sedov(teracell, folder, cells):
    """The point blast of Sedov on cells^3 cells of an octant: what is wrong with the computed one."""
    case, width = octant(teracell, folder, cells, SEDOV_LENGTH, SEDOV_CHARGE * SEDOV_LENGTH / cells)
    alpha = gas.sedov_profile()[3]
    energy = 1e4 * gas.P0 * (gas.GAMMA + 1) / 2 * alpha * SEDOV_RADIUS**3 / 0.16
    end = gas.sedov_time(energy, SEDOV_RADIUS)
    volume = case.charge_volume()
    case.run(gas.Charge(volume, energy / 8), end, end, first_step=end * 1e-5)
    radii, pressures = profile(case, case.end(), width)
    mass, total = totals(case, width, case.end())
    at_rest = gas.P0 / (gas.GAMMA - 1) * SEDOV_LENGTH**3
    r, p, _, _ = gas.sedov_profile()
    peak = gas.sedov_peak(SEDOV_RADIUS, end)
    seen = radii < 1.1
    exact = numpy.where(radii <= 1, peak * numpy.interp(radii, r, p), gas.P0)
    shells = radii[seen] ** 2
    steps, seconds = case.steps_and_seconds()
    return {"cells": cells**3, "cells_per_radius": SEDOV_RADIUS / width, "steps": steps, "seconds": seconds,
            "radius_error": front(radii, pressures) / SEDOV_RADIUS - 1,
            "profile_error": float((abs(pressures - exact)[seen] * shells).sum() / (exact[seen] * shells).sum()),
            "peak_error": float(pressures.max() / peak - 1),
            "mass_error": mass / (gas.RHO0 * SEDOV_LENGTH**3) - 1, "energy_error": total / (energy / 8 + at_rest) - 1,
            "radii": radii.tolist(), "pressures": (pressures / peak).tolist()}


TNT_LENGTH = 44.0
TNT_GAUGES = (10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0)
DIRECTIONS = ((1, 0, 0), (1, 1, 0), (1, 1, 1))  # along an axis, and the two diagonals


def tnt(teracell, folder, cells):
    """The burst of the stadium's charge in open air on cells^3 cells of an octant, beside the curve of Kinney and Graham."""
    case, width = octant(teracell, folder, cells, TNT_LENGTH, charge.RADIUS)
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
    steps, seconds = case.steps_and_seconds()
    return {"cells": cells**3, "cell": width, "steps": steps, "seconds": seconds, "gauges": rows}


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
