# SPDX-License-Identifier: Apache-2.0
"""The figures of a study, computed once more from its pictures by numpy; one value of a metric in studies, command and Python."""
import csv
import json

import numpy as np
import pytest
import subvol

STUDY = {
    "name": "mine",
    "inputs": [{"model": "ball", "resolution": 4}],
    "cameras": ["iso"],
    "size": [64, 48],
    "methods": [{"method": "splat", "per_edge": [1, 2]}, {"method": "tets", "levels": [0, 1]}],
    "metrics": ["mse", "rmse", "mae", "max", "psnr", "ssim", "ssim_linear", "flip", "flip_hdr"],
    "reference": {"tolerance": 0.01, "max_levels": 3},
    "tables": [{"rows": ["label", "per_edge", "levels"], "columns": ["psnr", "ssim"]}],
}


def srgb8(linear):
    """8-bit sRGB, in [0,1]."""
    x = np.clip(linear[..., :3].astype(np.float64), 0, 1)
    encoded = np.where(x <= .0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - .055)
    return np.round(encoded * 255) / 255


def blurred(plane):
    """By the Gaussian window of scikit-image, 11 pixels wide; only where it lies inside the picture."""
    taps = np.exp(-.5 * (np.arange(-5, 6) / 1.5) ** 2)
    taps /= taps.sum()
    across = np.apply_along_axis(np.convolve, 1, plane, taps, "valid")
    return np.apply_along_axis(np.convolve, 0, across, taps, "valid")


def ssim_of(a, b):
    """As skimage.metrics.structural_similarity(a, b, gaussian_weights=True, sigma=1.5, use_sample_covariance=False, data_range=1)."""
    m, n = blurred(a), blurred(b)
    v, w, s = blurred(a * a) - m * m, blurred(b * b) - n * n, blurred(a * b) - m * n
    c1, c2 = .01 ** 2, .03 ** 2
    return float(np.mean((2 * m * n + c1) * (2 * s + c2) / ((m * m + n * n + c1) * (v + w + c2))))


def figures_of(test, reference):
    a, b = (np.asarray(image)[..., :3].astype(np.float64) for image in (test, reference))
    mse = np.mean((a - b) ** 2)
    grey = np.array([.2125, .7154, .0721])  # rgb2gray of scikit-image
    return {"mse": mse, "rmse": mse ** .5, "mae": np.mean(abs(a - b)), "max": np.max(abs(a - b)), "psnr": -10 * np.log10(mse),
            "ssim": ssim_of(srgb8(a) @ grey, srgb8(b) @ grey), "ssim_linear": np.mean([ssim_of(a[..., c], b[..., c]) for c in range(3)])}


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    import os
    import subprocess
    program = os.environ.get("SUBVOL_COMMAND")
    if not program:
        pytest.skip("SUBVOL_COMMAND does not name the command")
    folder = tmp_path_factory.mktemp("study")
    (folder / "s.json").write_text(json.dumps(STUDY))
    done = subprocess.run([program, "study", "s.json", "-o", "out", "--exr", "--quiet"], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    cases = [json.loads(file.read_text()) for file in sorted((folder / "out/mine/cases").glob("*.json"))]
    rows = {row["id"]: row for row in csv.DictReader((folder / "out/mine/results.csv").read_text().splitlines())}
    return folder / "out", cases, rows


def pictures(out, case):
    return out / "mine" / case["files"]["exr"], out / "references" / (case["notes"]["reference"] + ".exr")


def test_figures_are_those_of_numpy(results):
    out, cases, rows = results
    assert len(cases) == 4
    for case in cases:
        test, reference = (subvol.read_image(path) for path in pictures(out, case))
        for name, value in figures_of(test, reference).items():
            assert case["metrics"][name] == pytest.approx(value, rel=1e-6), name
            assert float(rows[case["id"]][name]) == case["metrics"][name], name


def test_one_value_in_studies_command_and_python(results, command):
    out, cases, _ = results
    for case in cases:
        test, reference = pictures(out, case)
        said = json.loads(command("compare", test, reference, "--hdr", "--json"))
        compared = subvol.compare(subvol.read_image(test), subvol.read_image(reference))
        for name in ("mse", "rmse", "mae", "max", "psnr", "ssim", "ssim_linear", "flip"):
            assert case["metrics"][name] == said[name] == getattr(compared, name), name
        assert case["metrics"]["flip_hdr"] == said["hdr_flip"]
        assert said["srgb8"]["ssim"] == said["ssim"] != said["ssim_linear"]
        assert said["pixels_per_degree"] == pytest.approx(67.02, abs=.01)


def test_floors_are_the_metrics_of_the_last_refinement(results, command, tmp_path):
    """Of the level before the reference's: another picture, drawn by the command."""
    out, cases, _ = results
    reference = cases[0]["notes"]["reference"]
    level = int(cases[0]["metrics"]["reference_level"])
    coarser = tmp_path / "coarser.exr"
    command("render", "model:ball:4", "-o", coarser, "--method", "dense", "--levels", level - 1, "--size", "64x48", "--look", "volume",
            "--camera", out / "references/cameras" / f"{reference}.json", "--tf", "viridis")
    fine = subvol.read_image(out / "references" / f"{reference}.exr")
    for name, value in figures_of(subvol.read_image(coarser), fine).items():
        assert cases[0]["metrics"]["floor_" + name] == pytest.approx(value, rel=1e-4), name
