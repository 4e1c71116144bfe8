"""Meep runs on the permittivities that `teracell export --profile meep` writes, and has them where they belong."""
import unittest
import warnings

warnings.filterwarnings("ignore", message="The value of the smallest subnormal")  # Meep computes with them as zero
import meep
import numpy

from support import CELLS, SIZE, UNIFORM, dielectric_grid, exported, folder, mixed_metals

EPSILON = [1, 2.25, 9.5]


class Meep(unittest.TestCase):
    def test_permittivities_are_where_the_cells_are(self):
        grid = dielectric_grid()
        exported(grid, "eps.h5", "--profile", "meep", "--epsilon", "air=1,teflon=2.25,glass=9.5")
        expected = numpy.array(EPSILON)[numpy.load(exported(grid, "g.npy"))].transpose()  # [x][y][z]
        self.assertEqual(expected.shape, CELLS)

        meep.verbosity(0)
        source = meep.Source(meep.GaussianSource(0.3, fwidth=0.2), component=meep.Ez, center=meep.Vector3(1, 1, 0))
        simulation = meep.Simulation(cell_size=meep.Vector3(*SIZE), resolution=4, epsilon_input_file=f"{folder / 'eps.h5'}:eps", eps_averaging=False,
                                     sources=[source])
        simulation.run(until=3)
        self.assertTrue(numpy.isfinite(simulation.get_array(component=meep.Ez)).all())
        self.assertGreater(numpy.abs(simulation.get_array(component=meep.Ez)).max(), 0)
        compared = {epsilon: 0 for epsilon in EPSILON}
        for x, y, z in numpy.ndindex(*[n - 2 for n in CELLS]):
            around = expected[x:x + 3, y:y + 3, z:z + 3]  # between cells Meep interpolates
            if around.min() != around.max():
                continue
            centre = [(i + 1.5) * SIZE[d] / CELLS[d] - SIZE[d] / 2 for d, i in enumerate((x, y, z))]
            self.assertAlmostEqual(simulation.get_epsilon_point(meep.Vector3(*centre)).real, around[1, 1, 1], places=6, msg=str((x, y, z)))
            compared[around[1, 1, 1]] += 1
        self.assertTrue(all(compared.values()), compared)

    def test_a_mixed_cell_has_the_mean_of_what_it_is_made_of(self):
        grid, shares = mixed_metals()
        exported(grid, "mean.h5", "--profile", "meep", "--fractions", "--epsilon", "air=1,steel=2.25,brass=9.5")
        expected = (1 + 1.25 * shares["steel"] + 8.5 * shares["brass"]).transpose()
        self.assertGreater(len(numpy.unique(expected)), 3)  # there are mixed cells
        size = [b - a for a, b in zip(UNIFORM["min"], UNIFORM["max"])]
        meep.verbosity(0)
        simulation = meep.Simulation(cell_size=meep.Vector3(*size), resolution=4, epsilon_input_file=f"{folder / 'mean.h5'}:eps", eps_averaging=False)
        simulation.init_sim()
        found = simulation.get_array(component=meep.Dielectric)  # interpolated between cells; hdf5_test.py has them one by one
        self.assertGreater(len(numpy.unique(found.round(4))), 10)
        self.assertTrue((found > 1 - 1e-6).all() and (found < 9.5 + 1e-6).all())


if __name__ == "__main__":
    unittest.main()
