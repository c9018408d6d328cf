"""The picture of the force on a nut that turns on its bolt, exact beside meshes, and of how deep
they are: ``python docs/images/make_nut_ripple_picture.py``.

What is drawn is measured by ``standoff_studies.machines.nut_ripple``.
"""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import FuncFormatter

from standoff_studies.machines.nut_ripple import TURNED, pushes
from standoff_studies.machines.ripple import Push

HERE = Path(__file__).parent


def drawn_as(found: dict[str, Push]) -> None:
    fig, axes = plt.subplots(2, 1, figsize=(8.0, 5.4), sharex=True, constrained_layout=True)
    for name, push in found.items():
        style = {"color": "black", "lw": 1.8} if name == "exact" else {"lw": 1.1}
        turn = np.degrees(push.times)
        for ax, told in zip(axes, (push.force[:, 2], -1e6 * push.distance), strict=True):
            ax.plot(turn, told, label=name, **style)
    axes[0].set_ylabel("force along the axis\n(springs of 10 µm)")
    axes[1].set_ylabel("deepest place (µm)")
    axes[1].set_xlabel("turn of the nut (degrees)")
    axes[0].set_ylim(1.5, 300.0)
    axes[0].legend(loc="upper center", ncols=2, frameon=False)
    for ax in axes:
        ax.set_xlim(0.0, np.degrees(TURNED))
        ax.set_yscale("log")
        ax.yaxis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:g}"))
        ax.spines[["top", "right"]].set_visible(False)
    axes[1].set_ylim(8.0, 120.0)
    axes[1].set_yticks([10, 20, 50, 100])
    axes[1].minorticks_off()
    fig.savefig(HERE / "nut-ripple.png", dpi=110)


if __name__ == "__main__":
    drawn_as(pushes())
