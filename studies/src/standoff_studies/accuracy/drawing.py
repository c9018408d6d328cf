"""A heat map of Standoff's worst errors by pair."""

from __future__ import annotations

from collections.abc import Sequence
from typing import BinaryIO

import numpy as np
from matplotlib.figure import Figure

from standoff_studies.accuracy.measuring import OURS, Row
from standoff_studies.accuracy.report import side
from standoff_studies.accuracy.summary import QUANTITIES, summarised

FLOOR, CEILING = -17.0, -5.0
"""Powers of ten at the ends of the colour scale: below is roundoff, above is wrong."""


def draw(file: BinaryIO, rows: Sequence[Row]) -> None:
    """Draw the worst errors of distance, witness points and normal, for gaps and for depths."""
    ours = [row for row in rows if row.engine == OURS]
    names = list(dict.fromkeys(name for row in ours for name in (row.shape_1, row.shape_2)))
    sums = summarised(ours, lambda row: (row.shape_1, row.shape_2, side(row)))
    figure = Figure(figsize=(15, 10.5), layout="constrained")
    axes = figure.subplots(2, 3, sharex=True, sharey=True)
    for (number, which), line in zip(enumerate(("gaps", "depths")), axes, strict=True):
        for quantity, (title, ax) in enumerate(zip(QUANTITIES, line, strict=True)):
            values = np.full((len(names), len(names)), np.nan)
            for (first, second, where), found in sums.items():
                if where == which:
                    i, j = names.index(first), names.index(second)
                    worst = found.worst[quantity]
                    values[i, j] = values[j, i] = np.log10(max(worst, 10.0**FLOOR))
            image = ax.imshow(values, vmin=FLOOR, vmax=CEILING, cmap="viridis")
            ax.set_title(f"{title}, {which}")
            ax.set_yticks(range(len(names)), names, fontsize=7)
            if number == 1:
                ax.set_xticks(range(len(names)), names, rotation=90, fontsize=7)
            ax.tick_params(length=0)
    bar = figure.colorbar(image, ax=axes, shrink=0.6, label="worst error")
    ticks = np.arange(FLOOR, CEILING + 1, 2)
    bar.set_ticks(list(ticks), labels=[f"1e{int(t)}" for t in ticks])
    figure.savefig(file, format="png", dpi=100)
