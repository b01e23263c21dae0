# SPDX-License-Identifier: Apache-2.0
"""A study in ten lines: how fast samples of a known field converge. `02_a_study.py` needs matplotlib."""
import matplotlib.pyplot as plt
import numpy as np
import subvol

places = np.random.default_rng(0).uniform(-0.5, 0.5, (5000, 3))
sizes = [3, 4, 6, 8, 12]


def error(resolution: int, correction: str) -> float:
    """The root mean square error of the kernels of a ball against its formula, which a fine mesh stands for."""
    values, inside = subvol.evaluate(subvol.sample(subvol.model("ball", resolution), correction=correction), at=places)
    return float(np.sqrt(np.mean((values - exact)[inside] ** 2)))


exact, _ = subvol.evaluate(subvol.model("ball", 48), at=places, levels=1)
figure, axes = plt.subplots(figsize=(5, 4), layout="constrained")
for correction in ("none", "gradient", "second"):
    errors = [error(n, correction) for n in sizes]
    order = np.polyfit(np.log(sizes), np.log(errors), 1)[0]
    axes.loglog(sizes, errors, "o-", label=f"{correction} (order {-order:.1f})")
    print(correction, *(f"{e:.2e}" for e in errors), f"order {-order:.2f}")
axes.set(xlabel="cells along the inner cube", ylabel="rms error", title="What kernels carry beside their value", xticks=sizes, xticklabels=sizes)
axes.minorticks_off()
axes.legend()
figure.savefig("study.png", dpi=120)
