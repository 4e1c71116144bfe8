"""The MPI example: its numbers do not depend on the number of ranks."""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

PROGRAM = pathlib.Path(sys.argv.pop(1)).resolve()
ROOT = pathlib.Path(__file__).resolve().parents[2]
ENVIRONMENT = {**os.environ, "LD_LIBRARY_PATH": str(PROGRAM.parent), "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


def run(*args):
    done = subprocess.run([str(a) for a in args], env=ENVIRONMENT, capture_output=True, text=True)
    if done.returncode != 0:
        raise AssertionError(f"{args} ended with {done.returncode}: {done.stderr}")
    return done.stdout


class Wave(unittest.TestCase):
    def test_any_number_of_ranks_gives_the_same_bits(self):
        with tempfile.TemporaryDirectory() as folder:
            run(PROGRAM, "sample", "stadium", "-o", folder + "/s")
            run(PROGRAM, "mesh", folder + "/s/scene.json", "--cells", "200", "-o", folder + "/g.tcell")
            run("mpicxx", "-std=c++20", "-O2", "-I", ROOT / "store", ROOT / "tools/examples/wave_mpi.cpp", "-L", PROGRAM.parent, "-lteracell", "-o", folder + "/wave")
            alone = run("mpirun", "-n", "1", folder + "/wave", folder + "/g.tcell", "air", 80, 100)
            self.assertIn("100 x 80 x 20 cells", alone)
            gauges = [float(line.split()[2]) for line in alone.splitlines() if line.startswith("gauge")]
            self.assertGreater(sum(g != 0 for g in gauges), 3, "the wave has come to the gauges")
            self.assertTrue(all(abs(g) < 1 for g in gauges), "the scheme is stable")
            for ranks in (2, 3, 5):
                self.assertEqual(run("mpirun", "--oversubscribe", "-n", ranks, folder + "/wave", folder + "/g.tcell", "air", 80, 100), alone, f"{ranks} ranks")
            foreign = subprocess.run([folder + "/wave", folder + "/g.tcell", "air"], env={**ENVIRONMENT, "PMI_SIZE": "4"}, capture_output=True, text=True)
            self.assertEqual(foreign.returncode, 1)
            self.assertIn("expected 4 ranks, found 1", foreign.stderr, "the launcher of another MPI")


if __name__ == "__main__":
    unittest.main()
