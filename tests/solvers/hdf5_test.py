"""h5py and ParaView read what `teracell export` writes as HDF5 and XDMF: cell by cell, and where the cells lie."""
import json
import pathlib
import subprocess
import unittest

import h5py
import numpy

from support import GRADED, PROGRAM, exported, folder, metal_grids, mixed_metals, parts_of, refused, run

# Debian's ParaView can't be installed beside python3-vtk9, so it is unpacked here.
PARAVIEW = pathlib.Path(__file__).resolve().parents[2] / "build" / "paraview"
MEDIA = ("--epsilon", "air=1,steel=2.25,brass=9.5")
grids = metal_grids()


class H5py(unittest.TestCase):
    def test_plain(self):
        for kind, grid, more, cells in parts_of(grids):
            with h5py.File(exported(grid, "a.h5", *more)) as file:
                numpy.testing.assert_array_equal(file["material"][()], cells)
                self.assertEqual(file["material"].dtype, cells.dtype)
                self.assertEqual(file["materials/name"].asstr()[()].tolist(), ["air", "steel", "brass"])
                self.assertEqual(file["materials/color"].asstr()[()].tolist(), ["#00000000", "#8899aa", "#ccaa33"])
                self.assertEqual(file.attrs["units"], "mm")
                self.assertEqual(file.attrs["content_hash"], json.loads(run(PROGRAM, "info", "--json", grid))["file"]["hash"])
                if more:
                    continue
                self.assertEqual(file["planes_x"][()].tolist(), GRADED["x"]["planes"] if kind == "graded" else [-1 + i / 2 for i in range(25)])
                self.assertEqual(file["planes_z"][()].tolist(), [5 + i / 2 for i in range(11)])

    def test_shares_of_materials_in_mixed_cells(self):
        grid, shares = mixed_metals()
        with h5py.File(exported(grid, "s.h5", "--fractions")) as file:
            for id, expected in enumerate((1 - shares["steel"] - shares["brass"], shares["steel"], shares["brass"])):
                numpy.testing.assert_array_equal(file[f"fractions/{id}"][()], expected.astype("f4"))
                self.assertEqual(file[f"fractions/{id}"].attrs["material"], ["air", "steel", "brass"][id])
        with h5py.File(exported(grid, "mean.h5", "--fractions", "--profile", "meep", *MEDIA)) as file:
            numpy.testing.assert_allclose(file["eps"][()], (1 + 1.25 * shares["steel"] + 8.5 * shares["brass"]).transpose(), rtol=1e-15)

    def test_numbers_of_a_map(self):
        cells = numpy.load(exported(grids[0][1], "m.npy"))
        with h5py.File(exported(grids[0][1], "m.h5", "--map", "air=0,steel=700,brass=70000")) as file:
            numpy.testing.assert_array_equal(file["material"][()], numpy.array([0, 700, 70000])[cells])

    # gprMax reads `data`, dx_dy_dz and the lines of materials; it is not in Debian.
    def test_gprmax(self):
        for _, grid in grids[:2]:
            cells = numpy.load(exported(grid, "g.npy"))
            with h5py.File(exported(grid, "g.h5", "--profile", "gprmax", "--epsilon", "steel=1,brass=9.5", "--sigma", "steel=inf")) as file:
                numpy.testing.assert_array_equal(file["data"][()], numpy.array([-1, 0, 1])[cells].transpose())
                self.assertEqual(file["data"].dtype, numpy.int16)
                self.assertEqual(file.attrs["dx_dy_dz"].tolist(), [0.0005] * 3)
            self.assertEqual((folder / "g_materials.txt").read_text(), "#material: 1.0 inf 1.0 0 steel\n#material: 9.5 0.0 1.0 0 brass\n")

    # CSXCAD of Debian 12 can't read a DiscMaterial.
    def test_disc_material(self):
        for _, grid in grids:
            cells = numpy.load(exported(grid, "d.npy"))
            with h5py.File(exported(grid, "d.h5", "--profile", "openems", *MEDIA)) as file:
                numpy.testing.assert_array_equal(file["DiscData"][()], cells)
                self.assertEqual(file.attrs["Version"], 2.0)
                self.assertEqual(file["DiscData"].attrs["epsR"].tolist(), [1, 2.25, 9.5])
                self.assertEqual([file[f"mesh/{d}"].size for d in "zyx"], [n + 1 for n in cells.shape])

    def test_a_graded_grid_is_refused_by_profiles_without_planes(self):
        for profile in ("meep", "gprmax"):
            self.assertIn("graded axis x", refused(grids[2][1], "r.h5", "--profile", profile, *MEDIA))


def paraview():
    """The command of ParaView's Python."""
    if not (PARAVIEW / "done").exists():
        PARAVIEW.mkdir(parents=True, exist_ok=True)
        wanted = [line.split()[1] for line in run("apt-get", "install", "-s", "--no-install-recommends", "python3-paraview").splitlines() if line.startswith("Inst")]
        subprocess.run(["apt-get", "download", "-q", *wanted], cwd=PARAVIEW, check=True, stdout=subprocess.DEVNULL)
        for package in PARAVIEW.glob("*.deb"):
            run("dpkg", "-x", package, PARAVIEW)
            package.unlink()
        (PARAVIEW / "done").touch()
    usr = PARAVIEW / "usr"
    libraries = [usr / "lib", usr / "lib/x86_64-linux-gnu", usr / "lib/x86_64-linux-gnu/paraview-5.11", usr / "lib/x86_64-linux-gnu/openmpi/lib"]
    return ["env", "LD_LIBRARY_PATH=" + ":".join(map(str, libraries)), f"PYTHONPATH={usr}/lib/python3/dist-packages", usr / "bin/pvpython3.11"]


# Prints the planes, and saves the cells, by each of ParaView's two readers.
PARAVIEW_SCRIPT = """
import json, sys, numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXdmf2 import vtkXdmfReader
from vtkmodules.vtkIOXdmf3 import vtkXdmf3Reader
for kind in (vtkXdmfReader, vtkXdmf3Reader):
    reader = kind()
    reader.SetFileName(sys.argv[1])
    reader.Update()
    data = reader.GetOutputDataObject(0)
    while data.IsA("vtkMultiBlockDataSet"):
        data = data.GetBlock(0)
    numpy.save(sys.argv[2] + kind.__name__, vtk_to_numpy(data.GetCellData().GetArray("material")).reshape([n - 1 for n in data.GetDimensions()][::-1]))
    print(json.dumps([vtk_to_numpy(p).tolist() for p in (data.GetXCoordinates(), data.GetYCoordinates(), data.GetZCoordinates())]))
"""


class ParaView(unittest.TestCase):
    def test_every_cell_has_its_material_and_its_place(self):
        (folder / "read.py").write_text(PARAVIEW_SCRIPT)
        for kind, grid in grids[::2]:
            for i, more in enumerate(((), ("--region", "1,2,3,8,9,7"), ("--map", "air=0,steel=700,brass=9"), ("--map", "air=0,steel=70000,brass=9"))):
                cells = numpy.load(exported(grid, "x.npy", *more))
                exported(grid, "x.xdmf", *more)
                planes = [json.loads(line) for line in run(*paraview(), folder / "read.py", folder / "x.xdmf", folder / "read-").splitlines() if line[0] == "["]
                self.assertEqual(len(planes), 2)
                with h5py.File(folder / "x.h5") as file:
                    self.assertEqual(planes, [[file[f"planes_{d}"][()].tolist() for d in "xyz"]] * 2)
                for reader in ("vtkXdmfReader", "vtkXdmf3Reader"):
                    numpy.testing.assert_array_equal(numpy.load(folder / f"read-{reader}.npy"), cells)


if __name__ == "__main__":
    unittest.main()
