# SPDX-License-Identifier: Apache-2.0
"""Keywords that the library describes: help, stubs and refusals are made from the same descriptions as those of the command."""
import inspect
import os
import pathlib
import re
import subprocess

import pytest
import subvol
from subvol import _core, _options

CALLS = ["approximate", "approximate_series", "check_folds", "check_folds_between", "control_mesh", "evaluate_limit", "fit", "fit_shape", "from_vtk", "measure", "mend_folds", "mesh_difference", "page", "points_error", "probe", "rasterize", "read_mesh", "reduce", "render", "sample",
         "slice", "streamlines", "subdivide", "surface", "write_points", "write_series", "write_vdb", "write_wavelets"]


def test_the_stubs_are_current():
    stubs = pathlib.Path(subvol.__file__).with_name("__init__.pyi").read_text()
    assert stubs == _options.stubs(), "put what `_options.print_stubs()` prints into python/subvol/__init__.pyi"


def test_the_help_of_a_call_says_all_of_each_keyword():
    assert sorted(_core.keywords) == CALLS
    for name in CALLS:
        call = getattr(subvol, name)
        parameters = inspect.signature(call).parameters
        text = " ".join(inspect.getdoc(call).split())
        for key, kind, default, meaning, conditions in _core.keywords[name]:
            assert key in parameters, (name, key)
            assert meaning and f"{key}: {meaning}" in text, (name, key)
            for condition in conditions:
                assert condition in text, (name, key)
        assert "--" not in re.sub("`[^`]*`|as of --camera", "", text), name  # keywords, not options of the command


def test_types_ranges_and_defaults_are_those_of_the_library():
    per_edge = inspect.signature(subvol.render).parameters["per_edge"]
    assert (per_edge.annotation, per_edge.default, per_edge.kind) == ("int", 1, per_edge.KEYWORD_ONLY)
    entries = {key: (kind, default, conditions) for key, kind, default, _, conditions in _core.keywords["render"]}
    assert entries["per_edge"] == ("int", 1, ["1 to 64"])
    assert entries["levels"] == ("Optional[int]", None, ["0 to 10"])
    assert entries["tension"] == ("float", 1 / 16, ["0 to 0.125", "with scheme='mcq'"])
    assert entries["kernel"] == ("Kernel", "compact", [])
    assert entries["device"][2] == ["0 to 1000", "not with backend='cpu'"]


@pytest.mark.parametrize("options, flags", [
    ({"per_edge": 65}, ["--per-edge", "65"]),
    ({"levels": 11}, ["--levels", "11"]),
    ({"scheme": "cc", "tension": .03}, ["--scheme", "cc", "--tension", "0.03"]),
    ({"per_edge": 2, "spacing": .1}, ["--per-edge", "2", "--spacing", "0.1"]),
    ({"value_kernel": "bc"}, ["--value-kernel", "bc"]),
    ({"method": "tets", "per_edge": 2}, ["--method", "tets", "--per-edge", "2"]),
    ({"clip_box": (0, 0, 0, 1, 1, 0)}, ["--clip-box", "0,0,0,1,1,0"]),
    ({"clip": (0, 0, 0, 0, 0, 0)}, ["--clip", "0,0,0,0,0,0"]),
])
def test_a_refusal_is_the_sentence_of_the_command_with_keywords(options, flags, tmp_path):
    with pytest.raises(subvol.InvalidInput) as refused:
        subvol.render(subvol.model("ball", 2), size=(8, 8), **options)
    done = subprocess.run([os.environ["SUBVOL_COMMAND"], "render", "model:ball:2", "-o", tmp_path / "a.png", "--size", "8", *flags],
                          capture_output=True, text=True)
    assert done.returncode == 2

    def plain(text):
        """Without the marks of words and values, and the names in Python's form."""
        text = re.sub(r"--([a-z-]+)", lambda m: m[1].replace("-", "_"), text)
        return re.sub(r"[='\" ]+", " ", text).strip()

    assert plain(done.stderr.removeprefix("subvol: ")) == plain(str(refused.value))


def test_wrong_keywords_and_types_are_errors_of_python():
    ball = subvol.model("ball", 2)
    with pytest.raises(TypeError, match="'per_egde' is an unexpected keyword"):
        subvol.sample(ball, per_egde=2)
    with pytest.raises(TypeError, match="per_edge: a number is needed, not str"):
        subvol.sample(ball, per_edge="2")
    assert len(subvol.sample(ball, per_edge=None)) == len(subvol.sample(ball))  # None is the default


def test_kernels_are_names_or_dictionaries():
    ball = subvol.model("ball", 2)
    assert subvol.sample(ball, kernel=subvol.kernels()["bc"]).kernel == subvol.sample(ball, kernel="bc").kernel
