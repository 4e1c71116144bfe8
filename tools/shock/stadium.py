"""The burst of the tanker in front of the side stand: the case, and its fields as arrays."""
import pathlib
import subprocess

import numpy

import foam
import gas

TNT_MASS = 10e3  # kg: what the tanker carries
END, FRAME = 0.13, 0.0025  # s
LOW, HIGH = (-46.0, -108.0, 0.0), (80.0, 4.0, 57.0)  # m: what is computed, down to the ground
DOMAIN_LOW, DOMAIN_LENGTH = (-150.0, -120.0, -3.0), 300.0  # of the sample's scene
CHARGE = (17.0, -42.5, 3.3)
GAUGES = {
    "pitch, 15 m": (17, -27.5, 1.8), "pitch, 30 m": (17, -12.5, 1.8), "lower tier": (17, -58.5, 8.6), "upper tier": (17, -79, 30.0),
    "below the roof": (17, -70, 41.0), "ground floor": (17, -83, 3.4), "behind the stadium": (17, -105.5, 1.8),
}
OPEN = ("xmin", "xmax", "ymin", "ymax", "zmax")


class Blast:
    """The grid of the stadium with `cells` cells along it, and the case on the part that is computed. Pictures show the surfaces as
    `fine` cells along it have them."""

    def __init__(self, teracell, folder, cells, ranks=2, fine=600):
        self.folder = pathlib.Path(folder)
        self.width = DOMAIN_LENGTH / cells
        grid = self.mesh(teracell, cells, "grid.tcell")
        low = [round((a - b) / self.width) for a, b in zip(LOW, DOMAIN_LOW)]
        high = [round((a - b) / self.width) for a, b in zip(HIGH, DOMAIN_LOW)]
        low[2] -= 1  # a layer of the ground
        self.region = [*low, *high]
        self.corner = [b + self.width * i for b, i in zip(DOMAIN_LOW, low)]
        self.case = foam.Case(teracell, self.folder / "case", grid, self.region, OPEN, ranks)
        array = self.folder / "region.npy"
        run(teracell, "export", grid, "--region", ",".join(map(str, self.region)), "-o", array)
        self.materials = numpy.load(array)
        run(teracell, "export", self.mesh(teracell, fine, "fine.tcell"), "-o", self.folder / "fine.npy")

    def mesh(self, teracell, cells, name):
        if not (self.folder / "stadium/scene.json").exists():
            run(teracell, "sample", "stadium", "-o", self.folder / "stadium")
        run(teracell, "mesh", self.folder / "stadium/scene.json", "--cells", cells, "-o", self.folder / name)
        return self.folder / name

    def compute(self, end=END, frame=FRAME):
        for name, place in GAUGES.items():
            i, j, k = (int((a - b) / self.width) for a, b in zip(place, self.corner))
            if self.materials[k, j, i] != 0:
                raise RuntimeError(f"the gauge {name}: expected air at {place}, found a body; another number of cells may help")
        self.charge = gas.Charge(self.case.charge_volume(), TNT_MASS * gas.TNT, TNT_MASS)
        self.case.run(self.charge, end, frame, GAUGES.values(), far=100.0)
        centres = self.case.field("C", self.case.end())
        x, y, z = (numpy.floor((centres[:, a] - self.corner[a]) / self.width).astype(int) for a in range(3))
        self.index = z, y, x
        if len(numpy.unique(numpy.ravel_multi_index(self.index, self.materials.shape))) != len(z):
            raise RuntimeError("the mesh: expected a cell of the grid for each of its cells, found two in one")
        if numpy.any(self.materials[self.index] > 1):
            raise RuntimeError("the mesh: expected cells of air and explosive, found others")

    def array(self, name, time):
        """A field as [z][y][x], NaN where there is no gas."""
        result = numpy.full(self.materials.shape, numpy.nan, numpy.float32)
        result[self.index] = self.case.field(name, time)
        return result


def run(*command):
    subprocess.run([str(c) for c in command], check=True, stdout=subprocess.DEVNULL)
