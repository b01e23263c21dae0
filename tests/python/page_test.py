# SPDX-License-Identifier: Apache-2.0
"""Pages for browsers and notebooks."""
import html
import re

import numpy as np
import pytest

import subvol


def test_a_page_is_one_file(tmp_path):
    mesh = subvol.model("ball", 4)
    page = subvol.page(mesh, title="<a> ball", unit="K")
    assert page.report["bytes"] == len(page.html.encode())
    assert page.report["kept"] == page.report["points"] == len(mesh.points)
    field = mesh.fields["density"]
    assert page.report["max_error"] < 1e-3 * np.ptp(field)
    assert "&lt;a&gt; ball" in page.html
    page.write(tmp_path / "ball.html")
    assert (tmp_path / "ball.html").read_text() == page.html
    with pytest.raises(subvol.InvalidInput):
        page.write(tmp_path / "ball.txt")
    with pytest.raises(subvol.InvalidInput, match="isosurface"):
        subvol.page(mesh, look="isosurface")


def test_a_page_replaces_a_file_as_it_is(tmp_path):
    page = subvol.page(subvol.model("ball", 2))
    private = tmp_path / "private.html"
    private.write_text("before")
    private.chmod(0o600)
    (tmp_path / "link.html").symlink_to("private.html")
    page.write(tmp_path / "link.html")
    assert (tmp_path / "link.html").is_symlink()
    assert private.read_text() == page.html
    assert private.stat().st_mode & 0o777 == 0o600
    assert sorted(path.name for path in tmp_path.iterdir()) == ["link.html", "private.html"]
    with pytest.raises(OSError, match="does not exist"):
        page.write(tmp_path / "no" / "page.html")


def test_a_notebook_shows_it():
    page = subvol.page(subvol.model("ball", 4), look="volume", tf="coolwarm")
    frame = page._repr_html_()
    assert html.unescape(re.search(r'srcdoc="([^"]*)"', frame).group(1)) == page.html
    assert 'sandbox="allow-scripts"' in frame
