"""A case of OpenFOAM's rhoCentralFoam on a grid of teracell: the air and the explosive are its cells, all else is slip walls.

A charge is what fills the cells of the material "explosive". The mesh is exported twice: whole, because that is where the fields are set, and
in parts, which the ranks read.
"""
import functools
import json
import os
import pathlib
import re
import shutil
import subprocess

import numpy

import gas

FLUID = "air,explosive"
HEADER = "FoamFile {{ version 2.0; format ascii; class {}; object {}; }}\n"
SCHEMES = """fluxScheme Kurganov; ddtSchemes { default Euler; } gradSchemes { default Gauss linear; } divSchemes { default none; div(tauMC) Gauss linear; }
laplacianSchemes { default Gauss linear corrected; } snGradSchemes { default corrected; }
interpolationSchemes { default linear; reconstruct(rho) vanLeer; reconstruct(U) vanLeerV; reconstruct(T) vanLeer; }
"""
SOLUTION = 'solvers { "(rho|rhoU|rhoE)" { solver diagonal; } U { solver smoothSolver; smoother GaussSeidel; tolerance 1e-9; relTol 0; } e { $U; } }\n'
THERMO = """thermoType { type hePsiThermo; mixture pureMixture; transport const; thermo hConst; equationOfState perfectGas; specie specie;
energy sensibleInternalEnergy; }
mixture { specie { molWeight 28.96; } thermodynamics { Cp %r; Hf 0; } transport { mu 0; Pr 0.7; } }
""" % gas.CP
# Waves leave through open sides. Everything else, planes of symmetry too, is a wall along which gas slides.
FIELDS = {
    "p": ("volScalarField", "[1 -1 -2 0 0 0 0]", gas.P0, "zeroGradient;",
          "waveTransmissive; field p; psi thermo:psi; gamma %r; fieldInf %r; lInf %%r; value uniform %r;" % (gas.GAMMA, gas.P0, gas.P0)),
    "T": ("volScalarField", "[0 0 0 1 0 0 0]", gas.T0, "zeroGradient;", "zeroGradient;"),
    "U": ("volVectorField", "[0 1 -1 0 0 0 0]", "(0 0 0)", "slip;", "zeroGradient;"),
}
CONTROL = """application rhoCentralFoam; startFrom startTime; startTime 0; stopAt endTime; endTime {end!r}; deltaT {first_step!r}; adjustTimeStep yes; maxCo {courant!r};
maxDeltaT 1; writeControl adjustableRunTime; writeInterval {end!r}; writeFormat binary; writePrecision 12; timePrecision 9; functions {{
gauges {{ type probes; libs ("libsampling.so"); fields (p); probeLocations ({gauges}); writeControl timeStep; writeInterval 1; }}
frames {{ type writeObjects; libs ("libutilityFunctionObjects.so"); objects (p); writeOption anyWrite; writeControl adjustableRunTime; writeInterval {frame!r}; }}
centres {{ type writeCellCentres; libs ("libfieldFunctionObjects.so"); writeControl writeTime; }}
}}
"""


class Case:
    """Runs in `folder`, which is made anew, on `ranks` ranks. `region` is a box of cells."""

    def __init__(self, teracell, folder, grid, region=None, open_sides=(), ranks=2):
        self.teracell, self.grid, self.ranks = str(teracell), str(grid), ranks
        self.region = ["--region", ",".join(map(str, region))] if region else []
        self.folder = pathlib.Path(folder)
        self.open_sides = open_sides
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir(parents=True)

    def charge_volume(self):
        said = subprocess.run([self.teracell, "stats", self.grid, "--json", *self.region], check=True, capture_output=True, text=True).stdout
        return next(m["volume"] for m in json.loads(said)["materials"] if m["name"] == "explosive")

    def write(self, name, kind, text):
        path = self.folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(HEADER.format(kind, path.name) + text)

    def run(self, charge, end, frame, gauges=((0, 0, 0),), courant=0.4, first_step=1e-7, far=100.0):
        """Computes from 0 to `end`, in seconds, and writes the pressure whenever `frame` of them have passed. `far` is the distance beyond the open
        sides at which the air is at rest."""
        self.write("system/fvSchemes", "dictionary", SCHEMES)
        self.write("system/fvSolution", "dictionary", SOLUTION)
        self.write("constant/thermophysicalProperties", "dictionary", THERMO)
        self.write("constant/turbulenceProperties", "dictionary", "simulationType laminar;\n")
        self.write("system/controlDict", "dictionary", CONTROL.format(
            end=end, first_step=first_step, courant=courant, frame=frame, gauges=" ".join("(%r %r %r)" % tuple(map(float, g)) for g in gauges)))
        self.write("system/decomposeParDict", "dictionary", f"numberOfSubdomains {self.ranks}; method simple;\n")
        self.write("system/setFieldsDict", "dictionary", "defaultFieldValues (); regions ( zoneToCell { name explosive; fieldValues ("
                   f"volScalarFieldValue p {charge.pressure!r} volScalarFieldValue T {charge.temperature!r}); }} );\n")
        for name, (kind, dimensions, inside, wall, opening) in FIELDS.items():
            if name == "p":
                opening %= far
            self.write(f"0/{name}", kind, f'dimensions {dimensions}; internalField uniform {inside}; boundaryField {{ ".*" {{ type {wall} }}\n' +
                       "".join(f"{side} {{ type {opening} }}\n" for side in self.open_sides) + "}\n")
        for ranks in ([], ["--ranks", str(self.ranks)]):
            command = [self.teracell, "export", self.grid, "--format", "openfoam", "-o", str(self.folder), "--fluid", FLUID, "--zones", "--drop-unreachable"]
            self.log("export", [*command, *self.region, *ranks])
        self.foam("setFields")
        self.foam("decomposePar", "-fields")
        self.foam("rhoCentralFoam", parallel=True)

    def foam(self, *command, parallel=False):
        environment = "source /usr/share/openfoam/etc/bashrc >/dev/null 2>&1; export WM_PROJECT_DIR=/usr/share/openfoam"
        start, end = "exec", []
        if parallel:
            start, end = f"exec mpirun --oversubscribe --bind-to none -np {self.ranks}", ["-parallel"]
        self.log(command[0], ["bash", "-c", f'{environment}; {start} "$@"', "foam", *command, "-case", str(self.folder), *end])

    def log(self, name, command):
        """Runs a command. What it says goes into log.NAME, and its end into the message when it fails."""
        environment = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
        path = self.folder / f"log.{name}"
        with open(path, "a") as log:
            status = subprocess.run(command, stdout=log, stderr=subprocess.STDOUT, env=environment).returncode
        if status:
            raise RuntimeError(f"{path}: {name} ended with status {status}:\n{path.read_text()[-2000:]}")

    def times(self):
        """The times with fields, but 0."""
        found = [p.name for p in (self.folder / "processor0").iterdir() if re.fullmatch(r"[0-9][0-9.e+-]*", p.name) and p.name != "0"]
        return sorted(found, key=float)

    def field(self, name, time):
        """The values of all cells, in the order of cells."""
        return numpy.concatenate([read_field(self.folder / f"processor{rank}" / time / name, count) for rank, count in enumerate(self.counts)])

    @functools.cached_property
    def counts(self):
        """How many cells each rank has."""
        return [len(read_field(self.folder / f"processor{rank}" / self.end() / "C")) for rank in range(self.ranks)]

    def end(self):
        return self.times()[-1]

    def gauges(self):
        """Times, and for each of them the pressures of the gauges."""
        rows = numpy.loadtxt(self.folder / "postProcessing/gauges/0/p", ndmin=2)
        return rows[:, 0], rows[:, 1:]

    def steps_and_seconds(self):
        text = (self.folder / "log.rhoCentralFoam").read_text()
        return len(re.findall(r"^Time = ", text, re.M)), float(re.findall(r"^ExecutionTime = ([0-9.]+) s", text, re.M)[-1])


def read_field(path, cells=None):
    """The values of the cells of a binary field, as rows if they are vectors. `cells` says how many there are when one value stands for all."""
    data = path.read_bytes()
    if cells and (found := re.search(rb"internalField\s+uniform\s+([^;(]+);", data)):
        return numpy.full(cells, float(found[1]))
    found = re.search(rb"internalField\s+nonuniform\s+List<(\w+)>\s*(\d+)\s*\(", data)
    if not found:
        raise ValueError(f"{path}: expected a list of values, found none")
    width = {b"scalar": 1, b"vector": 3}[found[1]]
    values = numpy.frombuffer(data, "<f8", int(found[2]) * width, found.end())
    return values if width == 1 else values.reshape(-1, width)
