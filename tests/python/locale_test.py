# SPDX-License-Identifier: Apache-2.0
"""A host whose numbers have a decimal comma, as those of Qt, GTK and Blender may."""
import os
import shutil
import subprocess
import sys
import textwrap

import pytest
import subvol

HOST = textwrap.dedent("""
    import locale
    locale.setlocale(locale.LC_ALL, "de_DE.UTF-8")
    assert locale.localeconv()["decimal_point"] == ","
    import numpy as np
    import subvol
    for name in ("a.pvd", "a.xdmf"):
        series = subvol.open_series(name)
        assert list(series.times) == [0.25, 0.5], (name, series.times)
        assert [mesh.fields["f"][0] for _, mesh in series] == [0.25, 0.5], name
    mesh = subvol.read_mesh("a.pvd")
    assert len(mesh.cells) == 1 and mesh.points[:, 0].max() == 1.5
    subvol.write_mesh(mesh, "comma.mesh")
    points = subvol.sample(mesh)
    subvol.write_points(points, "comma.ply")
""")


@pytest.fixture
def german(tmp_path):
    """An environment in which the locale exists."""
    folder = tmp_path / "locale"
    folder.mkdir()
    if not shutil.which("localedef"):
        pytest.skip("there is no program localedef (Debian's libc-bin)")
    made = subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8", str(folder / "de_DE.UTF-8")], capture_output=True, text=True)
    if made.returncode != 0:
        pytest.skip("localedef has no definitions (Debian's package locales): " + made.stderr.strip())
    return {**os.environ, "LOCPATH": str(folder)}


def write_steps(folder):
    grids = ""
    for time in (0.25, 0.5):
        points = [(1.5 * x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
        numbers = " ".join(str(a) for point in points for a in point)
        grids += (f'<Grid><Time Value="{time}"/><Topology TopologyType="Hexahedron"><DataItem>0 1 3 2 4 5 7 6</DataItem></Topology>'
                  f'<Geometry><DataItem>{numbers}</DataItem></Geometry>'
                  f'<Attribute Name="f"><DataItem>{" ".join([str(time)] * 8)}</DataItem></Attribute></Grid>\n')
    (folder / "a.xdmf").write_text('<Xdmf><Domain><Grid GridType="Collection" CollectionType="Temporal">\n' + grids +
                                   "</Grid></Domain></Xdmf>")
    for step in (0, 1):
        subvol.write_mesh(subvol.read_mesh(folder / "a.xdmf", step=step), folder / f"t{step}.vtu")
    (folder / "a.pvd").write_text('<VTKFile type="Collection"><Collection><DataSet timestep="0.25" file="t0.vtu"/>'
                                  '<DataSet timestep="0.5" file="t1.vtu"/></Collection></VTKFile>')


def test_files_mean_the_same_in_a_host_with_a_comma(tmp_path, german):
    write_steps(tmp_path)
    done = subprocess.run([sys.executable, "-c", HOST], cwd=tmp_path, env=german, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    mesh = subvol.read_mesh(tmp_path / "a.pvd")
    subvol.write_mesh(mesh, tmp_path / "point.mesh")
    subvol.write_points(subvol.sample(mesh), tmp_path / "point.ply")
    for name in ("mesh", "ply"):
        assert (tmp_path / f"comma.{name}").read_bytes() == (tmp_path / f"point.{name}").read_bytes()
