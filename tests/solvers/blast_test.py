"""The blast of tools/examples/blast/run on few cells: the charge in open air beside the computation along its radius, and the first milliseconds in the
stadium, with a picture.

Usage: blast_test.py PATH_TO_TERACELL
"""
import os
import pathlib
import shutil
import sys
import tempfile
import unittest

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools/examples/blast"))
import gas  # noqa: E402
import open_air  # noqa: E402
import pictures  # noqa: E402
import stadium  # noqa: E402

PROGRAM = None


class Gas(unittest.TestCase):
    def test_a_charge_holds_its_energy_and_its_mass(self):
        charge = gas.Charge(116.0, 4e10, 1e4)
        thermal = charge.pressure / (gas.GAMMA - 1) * 116.0
        self.assertAlmostEqual(thermal - gas.P0 / (gas.GAMMA - 1) * 116.0, 4e10, delta=1)
        self.assertAlmostEqual(charge.pressure / (gas.R_GAS * charge.temperature) * 116.0, 1e4, delta=1e-6)

    def test_the_curve_falls_and_arrival_is_supersonic(self):
        peaks = gas.kinney_graham(numpy.array([1.0, 2.0, 5.0, 10.0]), 1.0) / gas.P0
        numpy.testing.assert_allclose(peaks, [9.956, 2.052, 0.2886, 0.09855], rtol=1e-3)
        self.assertLess(gas.kinney_graham_arrival(10, 1.0), 10 / gas.C0)


class Blast(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="teracell-blast-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def test_the_charge_in_open_air_comes_closer_to_the_computation_along_the_radius_on_a_finer_grid(self):
        model = open_air.tnt_along_radius()
        errors = []
        for n in (24, 36):
            pairs = list(zip(open_air.tnt(PROGRAM, self.folder / str(n), n)["gauges"], model))
            errors.append([numpy.mean([abs(g[key] / m[key] - 1) for g, m in pairs]) for key in ("peak", "arrival")])
        (coarse_peaks, coarse_arrival), (fine_peaks, fine_arrival) = errors
        self.assertLess(fine_peaks, 0.28)
        self.assertLess(fine_arrival, 0.06)
        self.assertLess(fine_peaks, 0.9 * coarse_peaks)
        self.assertLess(fine_arrival, coarse_arrival)

    def test_the_charge_bursts_on_the_stand(self):
        blast = stadium.Blast(PROGRAM, self.folder, 150, fine=200)
        blast.compute(end=0.008, frame=0.004)
        self.assertEqual(len(blast.case.times()), 2)
        times, pressures = blast.case.gauges()
        over = dict(zip(stadium.GAUGES, pressures.max(axis=0) - gas.P0))
        self.assertGreater(over["above the seats, 15 m"], 7e5)
        self.assertGreater(over["lower tier"], 1e5)
        for quiet in ("pitch", "upper tier", "behind the stadium"):  # the shock is not yet there
            self.assertLess(abs(over[quiet]), 1e3, quiet)
        view = pictures.View(blast, wide=240, high=120)
        first, last = (view.draw(blast.array("p", time)).astype(int) for time in blast.case.times())
        rest = view.draw(numpy.full(blast.materials.shape, gas.P0, numpy.float32)).astype(int)
        self.assertGreater(len(numpy.unique(rest)), 50, "the stadium is in the picture")
        changed = [(abs(picture - rest).max(axis=2) > 20).mean() for picture in (first, last)]
        self.assertGreater(changed[0], 0.005)
        self.assertGreater(changed[1], 1.3 * changed[0], "the blast grows")
        self.assertLess(changed[1], 0.5, "and is not everywhere")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()
