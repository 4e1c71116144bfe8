"""The air, the charge, and what is known of blasts in closed form. Pure: no files, no solver. SI units throughout."""
import functools
import math

import numpy

GAMMA = 1.4
R_GAS = 8314.47 / 28.96     # of air, J/(kg K)
CP = GAMMA / (GAMMA - 1) * R_GAS
P0, T0 = 101325.0, 288.15   # the air at rest
RHO0 = P0 / (R_GAS * T0)
C0 = math.sqrt(GAMMA * P0 / RHO0)
TNT = 4.184e6               # J/kg


class Charge:
    """Gas at rest that fills `volume`, with `energy` above that of air at rest. It is what is left when all of an explosive has become gas
    before any of it has moved. `mass` is that of the explosive; without it the gas is as dense as the air."""

    def __init__(self, volume, energy, mass=None):
        self.volume, self.energy = volume, energy
        self.mass = RHO0 * volume if mass is None else mass
        self.pressure = P0 + (GAMMA - 1) * energy / volume
        self.temperature = self.pressure * volume / (self.mass * R_GAS)


def energy_density(p, rho, speed_squared):
    return p / (GAMMA - 1) + rho * speed_squared / 2


@functools.lru_cache
def sedov_profile(points=4000):
    """L. I. Sedov's point blast in a gas without pressure, as L. D. Landau and E. M. Lifshitz (Fluid Mechanics, section 106) write it: arrays of
    r / R, of the pressure over that just behind the shock, and of the density over that ahead of it; and alpha in
    E = alpha rho R^5 / t^2. Notation: v is the gas velocity over 2 r / 5 t, and z the squared speed of sound over its square."""
    g = GAMMA
    nu1 = -(13 * g * g - 7 * g + 12) / ((3 * g - 1) * (2 * g + 1))
    nu2, nu3, nu5 = 5 * (g - 1) / (2 * g + 1), 3 / (2 * g + 1), -2 / (2 - g)
    nu4 = -nu1 / (2 - g)
    lowest, highest = 1 / g, 2 / (g + 1)  # v at the centre, at the shock
    above = (highest - lowest) * numpy.linspace(0, 1, points + 1)[1:] ** 6  # most points near the centre, where r is a small power of this
    v = lowest + above
    a, b, c = (g + 1) / (7 - g) * (5 - (3 * g - 1) * v), (g + 1) / (g - 1) * g * above, (g + 1) / (g - 1) * (1 - v)
    r = (((g + 1) * v / 2) ** -2 * a**nu1 * b**nu2) ** 0.2
    density = (g + 1) / (g - 1) * b**nu3 * a**nu4 * c**nu5
    z = g * (g - 1) * (1 - v) * v * v / (2 * g * above)
    pressure = density * r * r * z / g * 4 / 25  # over rho R^2 / t^2
    motion = density * (r * v) ** 2 * 4 / 25
    shell = 4 * math.pi * r * r * (pressure / (g - 1) + motion / 2)
    alpha = float(numpy.sum((shell[1:] + shell[:-1]) / 2 * numpy.diff(r)) + 4 / 3 * math.pi * r[0] ** 3 * pressure[0] / (g - 1))
    return r, pressure / pressure[-1], density, alpha


def sedov_radius(energy, time):
    return (energy * time * time / (sedov_profile()[3] * RHO0)) ** 0.2


def sedov_time(energy, radius):
    return math.sqrt(sedov_profile()[3] * RHO0 * radius**5 / energy)


def sedov_peak(radius, time):
    """The pressure just behind the shock."""
    return 2 / (GAMMA + 1) * RHO0 * (0.4 * radius / time) ** 2


def kinney_graham(distance, tnt):
    """Peak overpressure at a distance from `tnt` kilograms that burst in open air. G. F. Kinney, K. J. Graham: Explosive Shocks in Air, 1985."""
    z = distance / numpy.cbrt(tnt)
    return P0 * 808 * (1 + (z / 4.5) ** 2) / numpy.sqrt((1 + (z / 0.048) ** 2) * (1 + (z / 0.32) ** 2) * (1 + (z / 1.35) ** 2))


def kinney_graham_arrival(distance, tnt, steps=2000):
    """When the shock arrives, from its Mach number at each radius, beginning at the surface of solid TNT."""
    radius = numpy.linspace(0.0535 * tnt ** (1 / 3), distance, steps)
    slowness = 1 / (C0 * numpy.sqrt(1 + (GAMMA + 1) / (2 * GAMMA) * kinney_graham(radius, tnt) / P0))
    return float(numpy.sum((slowness[1:] + slowness[:-1]) / 2 * numpy.diff(radius)))
