"""Key "normals": the set of the paper's reference [28] beside Eqs. (1)-(4), near and far."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from standoff.typing import Array
from standoff_studies.paper import style
from standoff_studies.paper.figure import Artwork, Statement, measured_by, own_statement
from standoff_studies.paper.normals_contact import Track, tracked
from standoff_studies.paper.normals_study import (
    FORMS,
    Fate,
    begin,
    condition,
    focal_depth,
    newton,
    pair_at,
    scattered,
    turned,
)

PAPER, NORMALS, CONTACT = FORMS
NAMES = {PAPER: "Eqs. (1)–(4)", NORMALS: "normals, ref. [28]", CONTACT: "contact-regular"}
LOOK: dict[str, dict[str, Any]] = {form: style.line(k) for k, form in enumerate(FORMS)}

GAPS = np.logspace(-8, 2, 41)
"""Distances at which matrices are examined [length]; A's longest semi-axis is 1."""

DEPTHS = np.linspace(-0.7, 0.4, 111)
"""Signed distances in the second panel [length]: beyond the focal depth, and including 0."""

STARTS = 300
"""Starts scattered over both surfaces at each distance."""
START_DISTANCES = (-0.3, -0.05, 1e-6, 1e-3, 0.1, 1.0, 10.0, 100.0)
SEED = 1

ANGLES = np.array([0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.6, 0.8, 1.0, 1.2])
"""How far from the exact directions starts are on both ellipsoids [rad]."""
AT_EACH_ANGLE = 100
APART, INSIDE = 1.0, -0.05
"""Distances of the starts at angles [length]."""
NEAR_ANGLE = 0.3
SELDOM = 0.1
"""Share of the starts below which what they do is told as seldom."""
"""Angle of the starts whose steps are counted [rad]."""

FRAME = 2e-3
"""Frame time of the motion through contact [s]; one frame is at contact to within 1e-17."""


LAW = "Newton's iteration on each set of equations by itself: two faces, no tracker and no switch"
"""What the statements say they were measured with."""


@dataclass(frozen=True)
class Study:
    """Everything that the figure shows.

    ``conditions[form]``: (n, 2), plain and balanced, at `GAPS`; ``least[form]``: least singular
    value at `DEPTHS`; ``fates[form, d]`` of the scattered starts; ``shares[form, d]``: fraction of
    the starts at `ANGLES` that finds the answer; ``counts[form]``: median steps at
    `START_DISTANCES`; ``tracks``: by form, and for Eqs. (1)-(4) with contact between frames.
    """

    conditions: dict[str, Array]
    least: dict[str, Array]
    fates: dict[tuple[str, float], Fate]
    shares: dict[tuple[str, float], Array]
    counts: dict[str, Array]
    tracks: dict[str, Track]
    past: Track
    focal: float


@cache
def run() -> Study:
    """Do the whole study once."""
    pairs = {d: pair_at(d) for d in START_DISTANCES}
    fates = {
        (form, d): newton(pair, form, begin(pair, *scattered(STARTS, SEED)))
        for form in FORMS
        for d, pair in pairs.items()
    }
    shares = {
        (form, d): np.array([_near(form, d, angle).found.mean() for angle in ANGLES])
        for form in FORMS
        for d in (APART, INSIDE)
    }
    counts = {
        form: np.array([_median_steps(_near(form, d, NEAR_ANGLE)) for d in START_DISTANCES])
        for form in FORMS
    }
    return Study(
        conditions={form: _conditions(form) for form in FORMS},
        least={form: np.array([condition(pair_at(d), form)[1] for d in DEPTHS]) for form in FORMS},
        fates=fates,
        shares=shares,
        counts=counts,
        tracks={form: tracked(form, FRAME) for form in FORMS},
        past=tracked(PAPER, FRAME, first=0.5 * FRAME),
        focal=focal_depth(),
    )


def _conditions(form: str) -> Array:
    rows = [
        [condition(pair_at(gap), form, balanced=balanced)[0] for balanced in (False, True)]
        for gap in GAPS
    ]
    return np.array(rows)


def _near(form: str, distance: float, angle: float) -> Fate:
    pair = pair_at(distance)
    return newton(pair, form, begin(pair, *turned(pair, angle, AT_EACH_ANGLE, SEED)))


def _median_steps(fate: Fate) -> float:
    """Median over the starts that find the answer; nan if fewer than half do."""
    return float(np.median(fate.steps[fate.found])) if fate.found.mean() >= 0.5 else np.nan


def comparison() -> Artwork:
    """Condition, regular region, convergence and motion through contact of three equation sets."""
    study = run()
    return Artwork(
        caption=(
            "Three sets of equations for the witness points of two ellipsoids (A's longest "
            "semi-axis is 1 length). Condition: of each Jacobian at the exact points, with "
            "parameters in lengths; thin lines: after rows and columns are scaled. Least singular "
            f"value: 0 where a set fails; at the depth {study.focal:.2f} the answer itself ends. "
            "Part found: of plain Newton runs, from starts at an angle from the exact directions "
            "on both bodies, how many end at the witness points. Steps: the median from starts at "
            f"{NEAR_ANGLE:g} rad. Through contact: one feedforward and one Newton step a frame; "
            "the bodies touch at 0.25 s and part at 0.75 s, on frames (thick) or midway between "
            "two (thin, Eqs. (1)–(4) alone)."
        ),
        text=(
            "Six panels. The condition number of Eqs. (1)–(4) rises as 1/d towards contact, that "
            "of the two other sets does not; theirs rises away from contact. The least singular "
            "value of Eqs. (1)–(4) is zero at contact too, not at the focal depth alone. In "
            "penetration Eqs. (1)–(4) find the witness points from near starts only, and they lose "
            "them in a frame at contact."
        ),
        draw=_draw,
        tables=_tables(study),
        statements=measured_by(LAW, statements(study)),
    )


def statements(study: Study) -> tuple[Statement, ...]:
    """Return the statements on these numbers."""
    return (
        _near_contact(study),
        _far(study),
        _regular_region(study),
        _roots(study),
        _in_penetration(study),
        _from_far_starts(study),
        _steps(study),
        _through_contact(study),
        _only_faces(),
    )


def _measured(text: str, why: str = "") -> Statement:
    return own_statement("Ref. [28]", text, why)


def _near_contact(study: Study) -> Statement:
    at = {form: study.conditions[form][0, 0] for form in FORMS}
    return _measured(
        f"d = 1e-8: condition {at[PAPER]:.1e} of M, {at[NORMALS]:.1f} of the normals' set, "
        f"{at[CONTACT]:.1f} of the contact-regular form",
        "|det M| = d² |det J| for the normals' J, in unit tangents: at d = 0 two of M's four "
        "ranks are gone",
    )


def _far(study: Study) -> Statement:
    plain = {form: study.conditions[form][-1, 0] for form in FORMS}
    scaled = study.conditions[NORMALS][-1, 1]
    return _measured(
        f"d = 100: condition {plain[PAPER]:.1f} of M, {plain[NORMALS]:.0f} of the normals' set, "
        f"{plain[CONTACT]:.0f} of the contact-regular form; {scaled:.1f} of the normals' set with "
        "rows and columns scaled",
        "its first two rows grow with d, its last two do not: dividing by row norms mends it",
    )


def _regular_region(study: Study) -> Statement:
    zero = int(np.abs(DEPTHS).argmin())
    inner = (-study.focal + 0.02 < DEPTHS) & (DEPTHS < 0.4)
    least = {form: study.least[form] for form in FORMS}
    return _measured(
        f"least singular value at d = 0: {least[PAPER][zero]:.0e} of M, {least[NORMALS][zero]:.2f} "
        f"of the normals' set; from the focal depth {study.focal:.3f} (less 0.02) to d = 0.4 the "
        f"latter stays above {least[NORMALS][inner].min():.2f}",
        "the normals' set and the contact-regular form end where the answer itself ends, at the "
        "focal depth; M fails at d = 0 as well",
    )


def _roots(study: Study) -> Statement:
    counts = {form: study.fates[form, 0.1].common_normals for form in FORMS}
    return _measured(
        f"d = 0.1, {STARTS} starts over both surfaces: {counts[PAPER]} roots of (1)–(4), "
        f"{counts[NORMALS]} of the normals' set, the same ones; plain Newton ends at the witness "
        f"points in {study.fates[PAPER, 0.1].found.mean():.0%} and "
        f"{study.fates[NORMALS, 0.1].found.mean():.0%}",
        "each body has a near and a far point with the common normal; neither set tells n from −n, "
        "so antipodal normals are roots of both",
    )


def _often(runs: NDArray[np.bool_]) -> str:
    """How many of some runs did it, in a word: which of them did depends on the last bits."""
    share = float(runs.mean())
    return "never" if share == 0.0 else "seldom" if share < SELDOM else "often"


def _in_penetration(study: Study) -> Statement:
    paper, normals = study.fates[PAPER, INSIDE], study.fates[NORMALS, INSIDE]
    return _measured(
        f"d = {INSIDE:g}, {STARTS} starts: (1)–(4) {_often(paper.found)} end at the witness "
        f"points, at ΔR = 0 {_often(paper.meeting)}; the normals' set {_often(normals.found)} and "
        f"{_often(normals.meeting)}: {paper.found.mean():.1%}, {paper.meeting.mean():.0%}, "
        f"{normals.found.mean():.0%} and {normals.meeting.mean():.0%}",
        "every point where the surfaces intersect solves (1)–(4); the normals' set asks for "
        "parallel normals there too",
    )


def _from_far_starts(study: Study) -> Statement:
    at = int(np.flatnonzero(ANGLES == 0.8)[0])
    apart = {form: study.shares[form, APART][at] for form in FORMS}
    return _measured(
        f"d = {APART:g}, starts 0.8 rad off: (1)–(4) find the witness points in "
        f"{apart[PAPER]:.0%}, the normals' set in {apart[NORMALS]:.0%}, the contact-regular form "
        f"in {apart[CONTACT]:.0%}",
        "apart, H of (1)–(4) is positive definite over a wide region; and only (1)–(4) are a "
        "gradient, so that a line search on the distance can guard each step",
    )


def _steps(study: Study) -> Statement:
    at = START_DISTANCES.index(1e-6)
    far = START_DISTANCES.index(10.0)
    return _measured(
        f"median Newton steps from {NEAR_ANGLE:g} rad off: {study.counts[PAPER][at]:g} for (1)–(4) "
        f"and {study.counts[NORMALS][at]:g} for the normals' set at d = 1e-6; "
        f"{study.counts[PAPER][far]:g} and {study.counts[NORMALS][far]:g} at d = 10",
        "near contact M is nearly singular at the root: errors halve at first",
    )


def _through_contact(study: Study) -> Statement:
    greatest = {form: study.tracks[form].error.max() for form in FORMS}
    return _measured(
        f"through contact at {1e3 * FRAME:g} ms frames, greatest witness error: normals' set "
        f"{greatest[NORMALS]:.0e}, contact-regular {greatest[CONTACT]:.0e}, (1)–(4) "
        f"{greatest[PAPER]:.1f} with a frame at contact, {study.past.error.max():.0e} with contact "
        "midway between two frames",
        "at contact M is singular and its step arbitrary; the run then stays at another root",
    )


def _only_faces() -> Statement:
    return _measured(
        "the normals' set exists for two faces only; (1)–(4) serve edges and vertices by leaving "
        "out rows and columns",
        "an edge or a vertex has no normal of its own",
    )


def _tables(study: Study) -> dict[str, dict[str, ArrayLike]]:
    fates = list(study.fates.items())
    tracks = [(NAMES[form], track) for form, track in study.tracks.items()]
    tracks.append((f"{NAMES[PAPER]}, between frames", study.past))
    return {
        "condition": {
            "distance_length": GAPS,
            **{f"{form}, plain": study.conditions[form][:, 0] for form in FORMS},
            **{f"{form}, balanced": study.conditions[form][:, 1] for form in FORMS},
        },
        "least_singular_value": {"distance_length": DEPTHS, **study.least},
        "starts": {
            "form": [form for (form, _), _ in fates],
            "distance_length": np.array([d for (_, d), _ in fates]),
            "found": np.array([fate.found.mean() for _, fate in fates]),
            "other_common_normal": np.array([fate.other.mean() for _, fate in fates]),
            "intersection": np.array([fate.meeting.mean() for _, fate in fates]),
            "roots": np.array([float(fate.common_normals) for _, fate in fates]),
        },
        "start_angle": {
            "angle_rad": ANGLES,
            **{f"{form}, d = {d:g}": share for (form, d), share in study.shares.items()},
        },
        "steps": {"distance_length": np.array(START_DISTANCES), **study.counts},
        "through_contact": {
            "form": [name for name, track in tracks for _ in track.time],
            "time_s": np.concatenate([track.time for _, track in tracks]),
            "distance_length": np.concatenate([track.distance for _, track in tracks]),
            "witness_error_length": np.concatenate([track.error for _, track in tracks]),
        },
    }


def _draw() -> Figure:
    study = run()
    figure = style.new_figure(style.WIDTH, 9.2)
    panels = figure.subplots(3, 2)
    _draw_conditions(panels[0, 0], study)
    _draw_least(panels[0, 1], study)
    _draw_shares(panels[1, 0], study, APART, f"starts apart, d = {APART:g}")
    _draw_shares(panels[1, 1], study, INSIDE, f"starts in penetration, d = −{-INSIDE:g}")
    _draw_steps(panels[2, 0], study)
    _draw_tracks(panels[2, 1], study)
    handles, names = panels[0, 1].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside upper center", ncols=3, frameon=False)
    return figure


def _draw_conditions(axes: Axes, study: Study) -> None:
    for form in FORMS:
        plain, balanced = study.conditions[form].T
        axes.loglog(GAPS, plain, **LOOK[form])
        axes.loglog(GAPS, balanced, **LOOK[form] | {"linewidth": 0.7})
    axes.set(xlabel="distance d [length]", ylabel="condition number", title="condition")


def _draw_least(axes: Axes, study: Study) -> None:
    for form in FORMS:
        axes.plot(DEPTHS, study.least[form], **LOOK[form], label=NAMES[form])
    axes.axvline(-study.focal, color=style.QUIET, linewidth=1.0)
    axes.text(-study.focal + 0.02, 1.47, "focal depth", color="#555555", ha="left", va="top")
    axes.set(xlabel="signed distance d [length]", ylabel="least singular value", ylim=(0.0, 1.5))
    axes.set_title("where each set is regular")


def _draw_shares(axes: Axes, study: Study, distance: float, title: str) -> None:
    for k, form in enumerate(FORMS):
        axes.plot(ANGLES, study.shares[form, distance], **style.marked(k, 4))
    axes.set(xlabel="angle of the starts [rad]", ylabel="part found", ylim=(-0.03, 1.05))
    axes.set_title(title)


def _draw_steps(axes: Axes, study: Study) -> None:
    apart = np.array(START_DISTANCES) > 0.0
    for k, form in enumerate(FORMS):
        distances = np.array(START_DISTANCES)[apart]
        axes.semilogx(distances, study.counts[form][apart], **style.marked(k, 4))
    axes.set(xlabel="distance d [length]", ylabel="Newton steps", ylim=(0.0, 20.0))
    axes.set_yticks(range(0, 21, 4))
    axes.set_title(f"steps from {NEAR_ANGLE:g} rad off")


def _draw_tracks(axes: Axes, study: Study) -> None:
    for form in FORMS:
        track = study.tracks[form]
        axes.semilogy(track.time[1:], track.error[1:], **LOOK[form])
    past = study.past
    axes.semilogy(past.time[1:], past.error[1:], color=style.COLOURS[0], linewidth=0.7)
    for time in (0.25, 0.75):
        axes.axvline(time, color=style.QUIET, linewidth=1.0, zorder=0)
    axes.set(xlabel="time [s]", ylabel="witness error [length]", ylim=(1e-16, 1e2))
    axes.set_title("through contact")
