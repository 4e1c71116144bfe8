"""The air, the charge, and a curve of measured blasts. Pure: no files, no solver. SI units throughout."""
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
    before any of it has moved. `mass` is that of the explosive."""

    def __init__(self, volume, energy, mass):
        self.volume, self.energy, self.mass = volume, energy, mass
        self.pressure = P0 + (GAMMA - 1) * energy / volume
        self.temperature = self.pressure * volume / (self.mass * R_GAS)


def energy_density(p, rho, speed_squared):
    return p / (GAMMA - 1) + rho * speed_squared / 2


def kinney_graham(distance, tnt):
    """Peak overpressure at a distance from `tnt` kilograms that burst in open air. G. F. Kinney, K. J. Graham: Explosive Shocks in Air, 1985."""
    z = distance / numpy.cbrt(tnt)
    return P0 * 808 * (1 + (z / 4.5) ** 2) / numpy.sqrt((1 + (z / 0.048) ** 2) * (1 + (z / 0.32) ** 2) * (1 + (z / 1.35) ** 2))


def kinney_graham_arrival(distance, tnt, steps=2000):
    """When the shock arrives, from its Mach number at each radius, beginning at the surface of solid TNT."""
    radius = numpy.linspace(0.0535 * tnt ** (1 / 3), distance, steps)
    slowness = 1 / (C0 * numpy.sqrt(1 + (GAMMA + 1) / (2 * GAMMA) * kinney_graham(radius, tnt) / P0))
    return float(numpy.sum((slowness[1:] + slowness[:-1]) / 2 * numpy.diff(radius)))
