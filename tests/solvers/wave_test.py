"""The MPI example: its numbers do not depend on the number of ranks."""
import os
import pathlib
import subprocess
import unittest

from support import PROGRAM, folder, run

ROOT = pathlib.Path(__file__).resolve().parents[2]
ENVIRONMENT = {**os.environ, "LD_LIBRARY_PATH": str(PROGRAM.parent), "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


class Wave(unittest.TestCase):
    def test_any_number_of_ranks_gives_the_same_bits(self):
        wave = folder / "wave"

        def on_ranks(number):
            return run("mpirun", "--oversubscribe", "-n", number, wave, folder / "g.tcell", "air", 80, 100, env=ENVIRONMENT)

        run(PROGRAM, "sample", "stadium", "-o", folder / "s")
        run(PROGRAM, "mesh", folder / "s/scene.json", "--cells", "200", "-o", folder / "g.tcell")
        run("mpicxx", "-std=c++20", "-O2", "-I", ROOT / "store", ROOT / "tools/examples/wave_mpi.cpp", "-L", PROGRAM.parent, "-lteracell", "-o", wave)
        alone = on_ranks(1)
        self.assertIn("100 x 80 x 20 cells", alone)
        gauges = [float(line.split()[2]) for line in alone.splitlines() if line.startswith("gauge")]
        self.assertGreater(sum(g != 0 for g in gauges), 3, "the wave has come to the gauges")
        self.assertTrue(all(abs(g) < 1 for g in gauges), "the scheme is stable")
        for ranks in (2, 3, 5):
            self.assertEqual(on_ranks(ranks), alone, f"{ranks} ranks")
        foreign = subprocess.run([wave, folder / "g.tcell", "air"], env={**ENVIRONMENT, "PMI_SIZE": "4"}, capture_output=True, text=True)
        self.assertEqual(foreign.returncode, 1)
        self.assertIn("expected 4 ranks, found 1", foreign.stderr, "the launcher of another MPI")


if __name__ == "__main__":
    unittest.main()
