"""The blast of tools/examples/blast/run on few cells: Sedov's point blast, and the first milliseconds in the stadium, with pictures.

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
import plots  # noqa: E402
import stadium  # noqa: E402

PROGRAM = None


class Gas(unittest.TestCase):
    def test_the_point_blast_is_sedovs(self):
        r, p, density, alpha = gas.sedov_profile()
        self.assertAlmostEqual(alpha, 0.851072, places=6)  # J. R. Kamm, F. X. Timmes, LA-UR-07-2849
        self.assertAlmostEqual(p[0], 0.36546, places=4)
        self.assertAlmostEqual(density[-1], 6, places=9)
        swept = 4 * numpy.pi * numpy.trapz(density * r * r, r)
        self.assertAlmostEqual(swept / (4 / 3 * numpy.pi), 1, places=5)  # the mass that the shock has met
        radius = gas.sedov_radius(1e9, 1e-3)
        self.assertAlmostEqual(gas.sedov_time(1e9, radius), 1e-3, places=12)

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

    def test_the_point_blast_comes_closer_on_a_finer_grid_and_nothing_is_lost(self):
        coarse, fine = (open_air.sedov(PROGRAM, self.folder / str(n), n) for n in (12, 24))
        self.assertLess(abs(fine["radius_error"]), 0.02)
        self.assertLess(fine["profile_error"], 0.25)
        self.assertLess(fine["profile_error"], 0.9 * coarse["profile_error"])
        for result in (coarse, fine):
            self.assertLess(abs(result["mass_error"]), 1e-6)
            self.assertLess(abs(result["energy_error"]), 1e-6)
        self.assertEqual(open_air.sedov(PROGRAM, self.folder / "again", 12)["pressures"], coarse["pressures"])

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
        plots.gauges(self.folder / "gauges.svg", list(stadium.GAUGES), times, pressures, {"above the seats, 15 m": (0.005, 3e6)})
        self.assertGreater((self.folder / "gauges.svg").stat().st_size, 10000)

        view = pictures.View(blast, wide=240, high=120)
        first, last = (view.draw(blast.array("p", time)).astype(int) for time in blast.case.times())
        rest = view.draw(numpy.full(blast.materials.shape, gas.P0, numpy.float32)).astype(int)
        self.assertGreater(len(numpy.unique(rest)), 50, "the stadium is in the picture")
        changed = [(abs(picture - rest).max(axis=2) > 20).mean() for picture in (first, last)]
        self.assertGreater(changed[0], 0.005)
        self.assertGreater(changed[1], 1.3 * changed[0], "the blast grows")
        self.assertLess(changed[1], 0.5, "and is not everywhere")
        pictures.draw_frame(self.folder / "frame.png", blast, view, blast.case.times()[-1])
        self.assertGreater((self.folder / "frame.png").stat().st_size, 50000)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()
