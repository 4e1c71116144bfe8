"""A charge bursts on the side stand: the scene, the case, and its fields as arrays."""
import json
import pathlib
import subprocess

import numpy

import charge
import foam
import gas

END, FRAME = 0.13, 0.0025  # s
LOW, HIGH = (-46.0, -108.0, 0.0), (80.0, 4.0, 57.0)  # m: what is computed, down to the ground
DOMAIN_LOW, DOMAIN_LENGTH = (-150.0, -120.0, -3.0), 300.0  # of the sample's scene
CHARGE = (17.0, -57.0, 8.8)  # m: it lies on the seats of the lower tier, which rises by 1 m for each 2 m towards -y
SLOPE = (0.0, 5**-0.5, 2 * 5**-0.5)  # the normal of that tier
GAUGES = {
    "above the seats, 15 m": tuple(c + 15 * n for c, n in zip(CHARGE, SLOPE)), "above the seats, 30 m": tuple(c + 30 * n for c, n in zip(CHARGE, SLOPE)),
    "lower tier": (37, -57, 8.0), "upper tier": (17, -79, 30.0), "below the roof": (17, -70, 41.0), "ground floor": (17, -83, 3.4),
    "pitch": (17, -12.5, 1.8), "behind the stadium": (17, -105.5, 1.8),
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
        run(teracell, "mesh", self.scene(teracell), "--cells", cells, "-o", self.folder / name)
        return self.folder / name

    def scene(self, teracell):
        """The sample's stadium with the charge in it. What its tanker carries stays what it is: here it is a solid."""
        folder = self.folder / "stadium"
        if not (folder / "scene.json").exists():
            run(teracell, "sample", "stadium", "-o", folder)
        scene = json.loads((folder / "scene.json").read_text())
        for body in scene["bodies"]:
            if body["material"] == "explosive":
                body["material"] = "structure"
        (folder / "burst.obj").write_text(charge.sphere_obj(charge.RADIUS, CHARGE))
        scene["bodies"].append({"name": "burst", "mesh": "burst.obj", "material": "explosive", "priority": 3})
        (folder / "burst.json").write_text(json.dumps(scene, indent=1) + "\n")
        return folder / "burst.json"

    def compute(self, end=END, frame=FRAME):
        for name, place in GAUGES.items():
            i, j, k = (int((a - b) / self.width) for a, b in zip(place, self.corner))
            if self.materials[k, j, i] != 0:
                raise RuntimeError(f"the gauge {name}: expected air at {place}, found a body; another number of cells may help")
        filling = gas.Charge(self.case.charge_volume(), charge.TNT_MASS * gas.TNT, charge.TNT_MASS)
        self.case.run(filling, end, frame, GAUGES.values(), far=100.0)
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
