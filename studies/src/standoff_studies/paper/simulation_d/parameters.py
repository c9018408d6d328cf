"""Fig. 18: the faces' parameters against time, constant where the point's foot is on an edge."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from standoff.recording import Recording
from standoff.typing import Array
from standoff_studies.paper import style
from standoff_studies.paper.figure import Artwork, Statement, measured_by, own_statement
from standoff_studies.paper.keys import key_below, key_fill, key_line
from standoff_studies.paper.pair_simulation import Simulation
from standoff_studies.paper.panels import draw_errors, name_above, tint, unit_interval
from standoff_studies.paper.patch_places import place_on, short
from standoff_studies.paper.resets import reset_statement, reset_table
from standoff_studies.paper.simulation_d.runs import SIMULATION, face_parameters, settling_steps
from standoff_studies.paper.start_decay import decay_statement

SHADES = {"face": None, "edge": "#FBE3C0", "vertex": "#BDBDBD"}
"""Background of the stays on each kind of feature."""

DECAY = (0.05, 0.25)
"""Times between which the decay of the start is measured [s]: later the law's error dominates."""

LEAST_NAMED = 0.08
"""Shortest stay that is named [s]: a shorter one has no room for a name."""


def figure_18() -> Artwork:
    """Draw the faces' parameters."""
    runs = SIMULATION
    recording = runs.paper
    table: dict[str, ArrayLike] = {"time_s": recording.time}
    for face in range(runs.a.n_faces):
        u, v = face_parameters(recording, face).T
        table |= {f"u_face_{face}": u, f"v_face_{face}": v}
    table["feature"] = [str(feature) for feature in recording.feature_a]
    table["error"] = runs.witness_error
    return Artwork(
        caption=(
            "Simulation D: the parameters u and v of the lens's faces against time, by the printed "
            f"system at K = {runs.gain:g}/s from a wrong start; thin and dark, the library's own "
            "law. A face's parameters are drawn while the closest point is on it or on its "
            "boundary: an edge belongs to two faces, a vertex to all three. The modes are named on "
            "top; while the closest point is on an edge (tinted) u stays at exactly 0 or 1, and at "
            "the vertex (grey) v stays at 1 and u has no meaning. Below: how far the law's point "
            "is from the closest one, and the projection errors |Ψ|; rings are what each reset "
            "makes of them."
        ),
        text=(
            "Three panels, one a face, with two curves each. The curves of u end in level "
            "stretches at 0 or at 1 in the tinted times. In the lowest panel the error falls "
            "along a straight line from 1 to a millionth within half a second and jumps to a "
            "thousandth at each switch, from where it falls along such lines again."
        ),
        draw=_draw,
        tables={
            "parameters": table,
            "resets": reset_table(runs.resets),
        },
        statements=measured_by(runs.by, _statements(runs)),
    )


def edge_offsets(recording: Recording) -> Array:
    """Return |u - 0| or |u - 1| on both faces of the edge, for every frame on one, (n, 2)."""
    assert recording.pair is not None, "not opened from a file"
    lens = recording.pair[0]
    offsets = []
    for feature, parameters in zip(recording.feature_a, recording.parameters_a, strict=True):
        if feature.kind == "edge":
            places = [place_on(lens, face, feature, parameters) for face in range(lens.n_faces)]
            offsets.append([min(abs(p.u), abs(p.u - 1.0)) for p in places if p is not None])
    return np.array(offsets)


def _statements(runs: Simulation) -> tuple[Statement, ...]:
    offsets = edge_offsets(runs.paper)
    stays = [visit for visit in runs.exact.modes() if visit.feature_a.kind == "edge"]
    error = runs.witness_error[settling_steps(runs.paper) :]
    return (
        decay_statement(runs.paper, runs.paths, DECAY, runs.gain, runs.by),
        reset_statement(runs.resets, runs.by),
        Statement(
            "Fig. 18",
            "the parameters have constant stretches at 0 or 1 where the point lies on an edge",
            f"{len(stays)} stretches of {min(v.end - v.start for v in stays):.2f} to "
            f"{max(v.end - v.start for v in stays):.2f} s; there u is off 0 or 1 by "
            f"{offsets.max(initial=0.0):.0e} in {len(offsets)} frames",
            bool(len(offsets) and offsets.max() == 0.0),
            "on an edge u is read from the edge's own line in (u, v)",
            constructed=True,
        ),
        own_statement(
            "Fig. 18",
            f"once settled 99 % of the frames are within {np.quantile(error, 0.99):.1e} of the "
            f"closest point, and all within {error.max():.1e} (Heun, 1 kHz; the point moves at "
            "3.2/s)",
            "a switch falls into a frame, and what it leaves decays within 3/K = "
            f"{3.0 / runs.gain:g} s",
        ),
    )


def _draw() -> Figure:
    runs = SIMULATION
    recording = runs.paper
    figure = style.new_figure(style.WIDTH, 8.2)
    panels = figure.subplots(4, 1, sharex=True, height_ratios=[1.0, 1.0, 1.0, 1.5])
    for face, axes in enumerate(panels[:3]):
        _shade(axes, runs)
        u, v = face_parameters(recording, face).T
        axes.plot(recording.time, u, color=style.BLUE, label="u")
        axes.plot(recording.time, v, color=style.RED, linestyle="--", label="v")
        for own in face_parameters(runs.exact, face).T:
            axes.plot(runs.exact.time, own, color=style.BLACK, linewidth=0.6, zorder=3)
        unit_interval(axes, f"F{face}: u, v [–]")
    named = [v for v in runs.exact.modes() if v.end - v.start >= LEAST_NAMED]
    name_above(panels[0], [(visit, short(visit.feature_a)) for visit in named])
    _shade(panels[3], runs)
    draw_errors(panels[3], runs, linewidth=1.2, label="witness point")
    panels[3].set_ylabel("error [radius],\n|Ψ| [radius²]")
    panels[3].set_yticks([1e-12, 1e-8, 1e-4, 1.0])
    panels[3].set_ylim(1e-13, 300.0)
    panels[3].set_xlabel("time [s]")
    panels[3].set_xlim(0.0, recording.time[-1])
    keys = [
        key_line("u", style.BLUE),
        key_line("v", style.RED, dashes="--"),
        key_line("library's law", style.BLACK, 0.6),
        key_fill("on an edge", str(SHADES["edge"])),
        key_fill("at the vertex", str(SHADES["vertex"])),
    ]
    key_below(figure, keys, 5)
    figure.align_ylabels()
    return figure


def _shade(axes: Axes, runs: Simulation) -> None:
    tint(axes, [(visit, SHADES[visit.feature_a.kind]) for visit in runs.exact.modes()])
    for visit in runs.exact.modes():
        axes.axvline(visit.start, color=style.QUIET, linewidth=0.5, zorder=1)
