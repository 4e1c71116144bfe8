# For a repository of Spack: packages/teracell/package.py. "../fill" writes version, url and sha256.
from spack_repo.builtin.build_systems.cmake import CMakePackage, generator

from spack.package import *


class Teracell(CMakePackage):
    """Turns triangle surfaces and CAD assemblies into Cartesian grids of up to trillions of cells, and stores, reads and serves them."""

    version(
        "0.1.0",
        url="https://not-published.invalid/teracell-0.1.0.tar.gz",
        sha256="0000000000000000000000000000000000000000000000000000000000000000",
    )

    variant("hdf5", default=True, description="Export HDF5 and XDMF")
    variant("mpi", default=False, description="Build teracell_mpi, which meshes with many processes")
    variant("python", default=False, description="Build the Python package")
    variant("step", default=False, description="Build teracell-step, which reads STEP files")
    variant("web", default=False, description="Build the dashboard into the program; npm fetches its packages during the build")

    # Spack has no package of stb.
    resource(
        name="stb",
        url="https://github.com/nothings/stb/raw/f58f558c120e9b32c217290b80bad1a0729fbb2c/stb_image_write.h",
        sha256="cbd5f0ad7a9cf4468affb36354a1d2338034f2c12473cf1a8e32053cb6914a05",
        expand=False,
        placement="stb-include/stb",
    )

    generator("ninja")

    depends_on("c", type="build")
    depends_on("cxx", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("pkgconfig", type="build")
    depends_on("boost@1.74:", type="build")
    depends_on("cli11", type="build")
    depends_on("nlohmann-json@3.11:", type="build")
    depends_on("curl@7.85:")
    depends_on("expat")
    depends_on("fmt")
    depends_on("minizip")
    depends_on("xxhash")
    depends_on("zlib-api")
    depends_on("zstd@1.5:")
    depends_on("hdf5~mpi", when="+hdf5")
    depends_on("mpi", when="+mpi")
    depends_on("opencascade@7.6:+data_exchange", when="+step")
    depends_on("node-js@18:", type="build", when="+web")
    depends_on("npm", type="build", when="+web")

    extends("python@3.11:", when="+python")
    depends_on("py-pybind11", type="build", when="+python")
    depends_on("py-numpy", type="run", when="+python")

    conflicts("platform=darwin", msg="teracell builds on Linux only")
    conflicts("platform=windows", msg="teracell builds on Linux only")

    def cmake_args(self):
        args = [
            self.define("STB_INCLUDE_DIR", join_path(self.stage.source_path, "stb-include")),
            self.define("TERACELL_LIBRARY", True),
            self.define("TERACELL_UNITY", True),
            self.define_from_variant("TERACELL_HDF5", "hdf5"),
            self.define_from_variant("TERACELL_MPI", "mpi"),
            self.define_from_variant("TERACELL_PYTHON", "python"),
            self.define_from_variant("TERACELL_STEP", "step"),
            self.define_from_variant("TERACELL_WEB", "web"),
        ]
        if self.spec.satisfies("+python"):
            args.append(self.define("Python_EXECUTABLE", self.spec["python"].command.path))
            args.append(self.define("TERACELL_PYTHON_DIR", self.spec["python"].package.platlib))
        return args

    def test_stadium(self):
        """the sample is meshed, and the grid is sound"""
        teracell = which(join_path(self.prefix.bin, "teracell"), required=True)
        teracell("sample", "stadium", "-o", "stadium")
        teracell("mesh", "stadium/scene.json", "--cells", "200", "-o", "stadium.tcell")
        teracell("verify", "stadium.tcell")
