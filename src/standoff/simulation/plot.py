"""A run of a system as one picture: paths, distances, contact forces and energies over time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import BinaryIO

import numpy as np

from standoff.errors import of_extra
from standoff.simulation.rigid_body import FIXED
from standoff.simulation.system_run import SystemRun
from standoff.typing import Array

with of_extra("matplotlib"):
    from matplotlib.axes import Axes
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure


# Okabe and Ito's colours, told apart by eyes without red or green.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#E69F00", "#CC79A7", "#56B4E9", "black")
HANDLE = "#7F7F7F"
"""Grey: of a coupler and its device."""

SHOWN_IF_ANY = ("supplied", "by sharing springs")
"""Energies that many systems have none of."""

DASHES = ("-", "--", ":")
"""Of x, y and z."""

MOST_NAMED = 7
"""Most bodies or pairs that are drawn: more lines are not told apart. The title says how many are
not."""

SIZE = (9.0, 9.5)
"""Inches."""


def write_plot(
    run: SystemRun, names: Sequence[str], title: str, unit: str, target: tuple[BinaryIO, str]
) -> None:
    """Draw a run.

    Parameters
    ----------
    run : SystemRun
    names : sequence of str
        Of the bodies, in the system's order.
    title, unit : str
        The scene's title, and its length unit.
    target : (BinaryIO, str)
        Where to write, and "png", "svg" or "pdf".
    """
    figure = Figure(figsize=SIZE, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(4, 1, sharex=True)
    _paths(axes[0], run, names, unit)
    _pairs(axes[1:3], run, names, unit)
    _energies(axes[3], run)
    for each in axes:
        each.margins(x=0.0)
        each.grid(alpha=0.25)
        each.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False, fontsize="small")
    axes[3].set_xlabel("time [s]")
    figure.suptitle(title)
    file, ending = target
    figure.savefig(file, format=ending, dpi=150)


def _paths(axes: Axes, run: SystemRun, names: Sequence[str], unit: str) -> None:
    moving = [k for k, body in enumerate(run.system.bodies) if body.kind != FIXED]
    for colour, number in zip(COLOURS, moving, strict=False):
        position = run.positions(number)
        for axis, dashes in enumerate(DASHES):
            axes.plot(
                run.times,
                position[:, axis],
                dashes,
                color=colour,
                label=f"{names[number]}, {'xyz'[axis]}",
            )
    if run.coupler is not None:
        for axis, dashes in enumerate(DASHES):
            label = f"device, {'xyz'[axis]}"
            place = run.coupler.handle_positions[:, axis]
            axes.plot(run.times, place, dashes, color=HANDLE, linewidth=0.9, label=label)
    axes.set_ylabel(f"position [{unit}]")
    if len(moving) > MOST_NAMED:
        axes.set_title(f"{len(moving) - MOST_NAMED} more bodies are not drawn", fontsize="small")


def _pairs(panels: Sequence[Axes], run: SystemRun, names: Sequence[str], unit: str) -> None:
    distances, forces = run.distances, np.linalg.norm(run.forces, axis=2)
    for number, (a, b) in list(enumerate(run.system.pairs))[:MOST_NAMED]:
        label = f"{names[a]} – {names[b]}"
        for axes, values in zip(panels, (distances, forces), strict=True):
            axes.plot(run.times, values[:, number], color=COLOURS[number], label=label)
    if run.coupler is not None:
        pull = np.linalg.norm(run.coupler.on_device[:, :3], axis=1)
        panels[1].plot(run.times, pull, color=HANDLE, linewidth=0.9, label="coupler, on the device")
        for time in _let_go(run):
            panels[1].axvline(time, color=HANDLE, linestyle=":", label="coupler lets go")
    panels[0].axhline(0.0, color="black", linewidth=0.6)
    panels[0].set_ylabel(f"distance [{unit}]")
    panels[1].set_ylabel("contact force" if run.coupler is None else "force")
    if len(run.system.pairs) > MOST_NAMED:
        more = len(run.system.pairs) - MOST_NAMED
        panels[0].set_title(f"{more} more pairs are not drawn", fontsize="small")


def _let_go(run: SystemRun) -> Array:
    """When the coupler let go, at the end of the record that shows it."""
    assert run.coupler is not None
    fault = run.coupler.fault
    found: Array = run.times[1:][(fault[1:] != 0) & (fault[:-1] == 0)]
    return found


def _energies(axes: Axes, run: SystemRun) -> None:
    energy = run.energy
    floor = energy.potential.min()
    lines = {
        "kinetic": energy.kinetic,
        "potential, from its least": energy.potential - floor,
        "stored in contacts": energy.stored,
        "dissipated": energy.dissipated,
        "supplied": energy.supplied,
        "balance": energy.balance - floor,
        "by sharing springs": energy.shared,
    }
    for colour, (name, values) in zip(COLOURS, lines.items(), strict=False):
        if name not in SHOWN_IF_ANY or np.any(values != 0.0):
            dashes = "--" if name == "balance" else "-"
            axes.plot(run.times, values, dashes, color=colour, label=name)
    if run.coupler is not None:
        axes.plot(run.times, run.coupler.stored, color=HANDLE, label="stored in the coupler")
        work = run.coupler.energy.device
        axes.plot(run.times, work, ":", color=HANDLE, label="the hand’s work")
    axes.set_ylabel("energy")
