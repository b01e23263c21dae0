# SPDX-License-Identifier: Apache-2.0
from spack.package import *


class Subvol(CMakePackage):
    """Subdivision volumes: hexahedral meshes refined, rendered as splats, exported as OpenVDB grids, measured."""

    homepage = "https://opensubvol.example"
    url = "https://opensubvol.example/releases/subvol-0.2.0.tar.xz"

    license("Apache-2.0")

    version("0.2.0", sha256="REPLACE_BY_SHA256SUMS")

    variant("hdf5", default=True, description="Read VTKHDF, CGNS, XDMF and Exodus II files of HDF5")
    variant("mpi", default=False, description="Let the command work in several processes of MPI")
    variant("python", default=True, description="Build the Python package")

    depends_on("cxx", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("ninja", type="build")
    depends_on("pkgconfig", type="build")
    for name in ("intel-tbb", "glm", "nlohmann-json", "pugixml", "ceres-solver", "eigen", "highway", "zlib-api", "xz", "lz4", "muparser",
                 "openvdb@10:", "embree@3.13:", "libepoxy", "libpng", "cairo+pdf", "openexr@3:", "openimageio", "cli11"):
        depends_on(name)
    depends_on("hdf5", when="+hdf5")
    depends_on("mpi", when="+mpi")
    extends("python", when="+python")
    depends_on("py-pybind11", when="+python")
    depends_on("py-numpy", when="+python")

    generator("ninja")

    def cmake_args(self):
        return [self.define("SUBVOL_TESTS", False), self.define("SUBVOL_WINDOW", "OFF"),
                self.define_from_variant("SUBVOL_HDF5", "hdf5"), self.define_from_variant("SUBVOL_MPI", "mpi"),
                self.define_from_variant("SUBVOL_PYTHON", "python")]
