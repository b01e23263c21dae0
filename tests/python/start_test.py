# SPDX-License-Identifier: Apache-2.0
"""What importing the package costs and loads."""
import subprocess
import sys


def python(program):
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_import_loads_neither_openvdb_nor_openimageio():
    libraries = python("import subvol; print(open('/proc/self/maps').read())")
    assert "_core" in libraries
    for late in ("libopenvdb", "libOpenImageIO", "_grids", "libcairo", "libhdf5"):
        assert late not in libraries, late


def test_import_loads_no_optional_package():
    loaded = python("import sys, subvol; print(*sys.modules)").split()
    for late in ("tqdm", "meshio", "pyvista", "matplotlib", "PIL", "asyncio", "unittest"):
        assert late not in loaded, late


def test_import_loads_few_libraries():
    # What an import costs is finding libraries and their symbols: OpenImageIO alone would bring 250.
    mapped = "{line.split()[-1] for line in open('/proc/self/maps') if '.so' in line}"
    more = python(f"import numpy; before = {mapped}; import subvol; print(*({mapped} - before))").split()
    assert 1 <= len(more) <= 45, more


def test_openvdb_is_loaded_by_the_first_grid():
    libraries = python("import subvol; g = subvol.rasterize(subvol.model('ball', 2), resolution=8); print(open('/proc/self/maps').read())")
    assert "libopenvdb" in libraries


def test_modules_are_found(tmp_path):
    # OpenEXR is in a module of the library: the extension finds it by its own RUNPATH, whatever the folder is.
    python(f"import os, subvol; os.chdir('/'); subvol.render(subvol.model('ball', 2), size=(8, 8)).write('{tmp_path}/a.exr')")
    assert (tmp_path / "a.exr").stat().st_size > 100
