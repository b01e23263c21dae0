# SPDX-License-Identifier: Apache-2.0
"""Optional libraries that are installed in part, damaged, or of another version: the configuration leaves them out, and says so in a line."""

import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
NAMES = ("mpi", "hdf5", "window", "python", "nanovdb")
UNUSABLE = "OFF; what is installed cannot be used"


class Optional(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)

    def put(self, name, text, mode=0o644):
        path = self.folder / "fake" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        path.chmod(mode)

    def package(self, name, libs, includes="/usr/include"):
        self.put(f"pkgconfig/{name}.pc", f"Name: {name}\nDescription: fake\nVersion: 99\nLibs: {libs}\nCflags: -I{includes}\n")

    def configured(self, *settings, **environment):
        """What is said of each library. The configuration must not end."""
        done = subprocess.run(
            [os.environ.get("SUBVOL_CMAKE", "cmake"), "-S", HERE, "-B", self.folder / "build", "-G", os.environ.get("SUBVOL_GENERATOR", "Ninja"),
             f"-DCMAKE_CXX_COMPILER={os.environ.get('SUBVOL_COMPILER', 'c++')}", f"-DSUBVOL_SOURCE={HERE.parents[2]}",
             f"-DCMAKE_PREFIX_PATH={self.folder}/fake", *settings],
            capture_output=True, text=True, timeout=600, env=os.environ | {"PKG_CONFIG_LIBDIR": f"{self.folder}/fake/pkgconfig"} | environment)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        said = re.findall(r"^-- subvol: (\w+): (.*)$", done.stdout, re.M)
        self.assertEqual(tuple(name for name, _ in said), NAMES, done.stdout)
        return {name: re.sub(r" \(SUBVOL_\w+\)", "", what) for name, what in said}

    def assert_unusable(self, said):
        for name, what in said.items():
            with self.subTest(library=name):
                self.assertTrue(what.startswith(UNUSABLE), what)
                log = Path(re.search(r"see (.*)$", what)[1])
                self.assertGreater(log.stat().st_size, 0)

    def test_files_that_end_the_configuration(self):
        """A folder that is not there, as with Open MPI's programs without its headers; configuration files with an error."""
        self.put("bin/mpicxx", f"#!/bin/sh\necho \"-I{self.folder}/gone -L{self.folder}/gone -lmpi\"\n", 0o755)
        for name in ("hdf5", "imgui"):
            self.package(name, "-lm", includes=self.folder / "gone")
        for name in ("glfw3", "pybind11"):
            self.put(f"lib/cmake/{name}/{name}Config.cmake", "message(FATAL_ERROR \"part of this package is missing\")\n")
            self.put(f"lib/cmake/{name}/{name}ConfigVersion.cmake", "set(PACKAGE_VERSION 99)\nset(PACKAGE_VERSION_COMPATIBLE TRUE)\n")
        self.put("include/nanovdb/util/OpenToNanoVDB.h", "#include \"gone.h\"\n")
        self.assert_unusable(self.configured(f"-DMPI_CXX_COMPILER={self.folder}/fake/bin/mpicxx"))

    def test_headers_without_library_and_other_versions(self):
        self.put("bin/mpicxx", "#!/bin/sh\necho broken >&2\nexit 1\n", 0o755)
        self.put("include/hdf5.h", "typedef long hid_t;\n")  # of a version without the calls
        self.package("hdf5", "-lhdf5_gone", includes=self.folder / "fake/include")
        self.package("imgui", "-limgui_gone")
        self.put("lib/cmake/glfw3/glfw3Config.cmake", "")
        self.put("lib/cmake/glfw3/glfw3ConfigVersion.cmake", "set(PACKAGE_VERSION 3.0)\n")
        self.put("lib/cmake/pybind11/pybind11Config.cmake", "add_library(pybind11::headers INTERFACE IMPORTED)\n")
        self.put("lib/cmake/pybind11/pybind11ConfigVersion.cmake", "set(PACKAGE_VERSION 99)\nset(PACKAGE_VERSION_COMPATIBLE TRUE)\n")
        self.put("include/pybind11/numpy.h", "#error of another version\n")
        self.put("include/nanovdb/util/OpenToNanoVDB.h", "namespace nanovdb {}\n")
        flags = f"-DCMAKE_CXX_FLAGS=-I{self.folder}/fake/include"
        self.assert_unusable(self.configured(f"-DMPI_CXX_COMPILER={self.folder}/fake/bin/mpicxx", flags))

    def test_what_is_not_installed_is_no_fault(self):
        said = self.configured()
        for name in ("hdf5", "window"):
            self.assertEqual(said[name], "OFF", name)


if __name__ == "__main__":
    unittest.main()
