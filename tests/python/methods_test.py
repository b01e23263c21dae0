# SPDX-License-Identifier: Apache-2.0
"""Each keyword of render() either changes what a method makes, or is refused by a sentence that names both."""
from pathlib import Path

import numpy as np
import pytest
import subvol

METHODS = ["splat", "sheets", "footprints", "tets", "pt", "dense", "grid"]
PLANE = (0, 0, 0, 1, 0, 0)

# For each keyword a value that matters, and what else it needs.
GIVEN = {
    "per_edge": (2, {}), "centers": (True, {}), "spacing": (.3, {}), "tolerance": (1e-3, {}), "values": ("cubic", {"per_edge": 2}),
    "value_kernel": ("compact", {"values": "paper", "per_edge": 2}), "kernel": ("gaussian", {}), "correction": ("none", {"look": "solid"}),
    "kbuffer": (1, {"order": "havs"}), "scheme": ("cc", {}), "tension": (.02, {}), "crease_angle": (10.0, {}), "levels": (2, {}), "samples": (3, {}),
    "image_tolerance": (.1, {}), "order": ("lists", {}), "lod": (30.0, {}), "seconds": (2.0, {}), "backend": ("gl", {}), "device": (0, {}),
    "sheets": (40, {}), "shade": (True, {}), "shadows": (True, {}), "ambient_occlusion": (.3, {}), "color_field": ("z", {}),
    "clip": (PLANE, {}), "clip_box": (0, 0, 0, 1, 1, 1), "slice": (PLANE, {}), "around": (True, {"slice": PLANE}),
}
GIVEN["clip_box"] = ((0, 0, 0, 1, 1, 1), {})


def table():
    """For each keyword of docs/pictures.md the methods that use it."""
    document = (Path(__file__).parents[2] / "docs/pictures.md").read_text()
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in document.splitlines() if line.startswith("| `--")]
    return {row[1].strip("`"): [method for method, cell in zip(METHODS, row[2:9]) if cell == "x"] for row in rows if len(row) == 11 and row[1]}


USES = table()


def test_each_keyword_of_the_table_is_tried():
    assert set(USES) == set(GIVEN)


@pytest.fixture(scope="module")
def bodies():
    ball = subvol.model("ball", 3)
    x, _, z = ball.points.T
    two = subvol.HexMesh(ball.points, ball.cells, {"x": x, "z": z * z})
    return two, subvol.rasterize(ball, resolution=12)[0]


def drawn(what, method, **options):
    image = subvol.render(what, size=(24, 20), method=method, look=options.pop("look", "volume"), **options)
    report = {name: value for name, value in image.report.items() if name not in ("seconds", "backend", "device")}
    return np.asarray(image).tobytes(), report, image.report.get("backend")


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("keyword", sorted(GIVEN))
def test_each_keyword_changes_the_output_or_is_refused(bodies, keyword, method):
    if method in ("sheets", "pt") and not subvol.gl_devices():
        pytest.skip("there is no OpenGL 4.5")
    what = bodies[1] if method == "grid" else bodies[0]
    value, needed = GIVEN[keyword]
    if keyword == "lod" and method == "pt":
        value, needed = .2, {"order": "havs"}
    if keyword == "tension" and method == "footprints":  # it shows the values of kernels alone, which are exact at control points
        needed = {"per_edge": 2}
    if method not in USES[keyword]:
        with pytest.raises(subvol.InvalidInput, match=f"^{keyword}: has no effect with method '{method}': "):
            subvol.render(what, size=(24, 20), method=method, **{keyword: value})
        return
    if keyword in ("backend", "device") and not subvol.gl_devices():
        pytest.skip("there is no OpenGL 4.5")
    field = {} if method == "grid" else {"field": "x"}
    after = drawn(what, method, **{keyword: value}, **needed, **field)
    if keyword != "device":  # the first one draws by default
        assert after != drawn(what, method, **needed, **field)


@pytest.mark.parametrize("options, said", [
    ({"method": "dense", "levels": 1, "image_tolerance": .1}, "image_tolerance: has no effect with levels"),
    ({"method": "pt", "lod": .5}, "lod: has no effect without order havs"),
    ({"scheme": "cc", "tension": .03}, "tension: has no effect without scheme='mcq'"),
    ({"backend": "cpu", "device": 0}, "device: has no effect with backend='cpu'"),
    ({"look": "solid", "shade": True}, "shade: has no effect with look='solid'"),
    ({"around": True}, "around: has no effect without slice"),
    ({"seconds": 1, "levels": 1}, "levels: has no effect with seconds"),
])
def test_keywords_that_others_make_useless_are_refused(options, said):
    with pytest.raises(subvol.InvalidInput, match=said):
        subvol.render(subvol.model("ball", 2), size=(8, 8), **options)


def test_names_that_are_unknown_are_refused():
    ball = subvol.model("ball", 2)
    with pytest.raises(subvol.InvalidInput, match="nonsense"):
        subvol.render(ball, size=(8, 8), color_field="nonsense")
    with pytest.raises(subvol.InvalidInput, match="order: 'bogus'"):
        subvol.render(ball, size=(8, 8), method="pt", order="bogus")
    with pytest.raises(subvol.InvalidInput, match="points"):
        subvol.render(subvol.sample(ball), size=(8, 8), per_edge=2)
    for call in (lambda: subvol.render(ball, size=(8, 8), tension=.2), lambda: subvol.subdivide(ball, 1, tension=.2)):
        with pytest.raises(subvol.InvalidInput, match="tension: 0.2 is out of range"):
            call()
