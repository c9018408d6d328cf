"""The projection errors at each switch, compared with those that its reset implies.

What a reset implies is computed independently here: the law's last step without any switch, then
the reset from the new feature's own data. No kernel that switches is used.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import groupby
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from scipy.optimize import brentq

from standoff.bodies import Body
from standoff.motion import Path
from standoff.recording import RecordedEvent, Recording
from standoff.tracking import Feature, Tracker, pair_system
from standoff.tracking.laws import PaperLaw
from standoff.typing import Array
from standoff_studies.paper import style
from standoff_studies.paper.figure import HYBRID, Statement, own_statement
from standoff_studies.paper.patch_places import BothPlaces, FeaturePlace, places_at, short

SAMPLES = 64
"""Samples of a pcurve, between which the parameter nearest to a face's own is sought."""

APART = 1e-7
"""Fraction of a pcurve's range over which its direction is computed; exact for a line."""

ROUNDED = 1e-12
"""Projection errors that differ by less are the same [length²]: the kernels and the last step here
round differently."""

LEAST_DRAWN = 1e-12
"""Projection errors below this are drawn at this value [length²]."""


EVERY = 5
"""Every how many frames one is drawn: 5 ms, at most an eighth of the fastest 1/K here."""


class Reset(NamedTuple):
    """The switches of one frame.

    Attributes
    ----------
    frame : int
    time : float
        Of the frame [s].
    names : str
        The features left and entered, such as "A F0 → E1".
    before, implied, found : float
        Size of the projection errors [length²]: on the old features at the end of the step, on
        the new ones where the reset puts the witness points, and in the recording.
    off : float
        Size of the difference between the last two [length²].
    """

    frame: int
    time: float
    names: str
    before: float
    implied: float
    found: float
    off: float


def resets_of(recording: Recording, paths: tuple[Path, Path], gain: float) -> list[Reset]:
    """Return the switches of a run of the printed system, frame by frame.

    Parameters
    ----------
    recording : Recording
    paths : (Path, Path)
        The motions along which it was made.
    gain : float
        K [1/s]
    """
    assert recording.pair is not None, "not opened from a file"
    tracker, found = _without_switches(recording, gain), []
    for frame, events in groupby(recording.events, key=lambda event: event.frame):
        switches = list(events)
        before = _stepped(tracker, recording, paths, frame)
        after = _reset(recording.pair, before, switches)
        now = places_at(recording, frame)
        assert [place[0] for place in after] == [place[0] for place in now], "the same features"
        poses = _at(recording, paths, frame)[:2]
        errors = [pair_system(*recording.pair, *poses, *own).Psi for own in (before, after, now)]
        names = ", ".join(f"{e.body} {short(e.source)} → {short(e.target)}" for e in switches)
        left, implied, seen = (float(np.linalg.norm(one)) for one in errors)
        off = float(np.linalg.norm(errors[1] - errors[2]))
        time = float(recording.time[frame])
        found.append(Reset(frame, time, names, left, implied, seen, off))
    return found


class Move(NamedTuple):
    """How the resets of one frame move the witness points.

    Attributes
    ----------
    way : float
        Change of ΔR [length].
    growth : float
        Change of the distance between the witness points, |ΔR| [length].
    """

    way: float
    growth: float


def moves_of(recording: Recording, paths: tuple[Path, Path], gain: float) -> list[Move]:
    """Return how the resets of a run of the printed system move the witness points, frame by frame.

    From the end of the law's step without any switch to the recorded witness points.
    """
    assert recording.pair is not None, "not opened from a file"
    tracker, found = _without_switches(recording, gain), []
    for frame in sorted({event.frame for event in recording.events}):
        poses = _at(recording, paths, frame)[:2]
        before, now = (
            pair_system(*recording.pair, *poses, *places).dR
            for places in (_stepped(tracker, recording, paths, frame), places_at(recording, frame))
        )
        growth = np.linalg.norm(now) - np.linalg.norm(before)
        found.append(Move(float(np.linalg.norm(now - before)), float(growth)))
    return found


def growth_statement(moves: Sequence[Move], starts: int, by: str) -> Statement:
    """Return how the printed resets change the distance; the paper's claim is on closest points."""
    moved = [move for move in moves if move.way > ROUNDED]
    grown = [move.growth for move in moved if move.growth > ROUNDED]
    of = f"in {len(moved)} of {len(moves)} frames with switches"
    told = (
        f"move a witness point {of}, ΔR by up to {max(move.way for move in moved):.2g} length; "
        f"the distance falls there by up to {max(-move.growth for move in moved):.2g} length, and "
        f"grows in {len(grown)}{f', by up to {max(grown):.1e} length' if grown else ''}"
        if moved
        else f"move a witness point {of}, so the distance does not change"
    )
    return own_statement(
        HYBRID,
        f"the printed resets, from {starts} wrong start{'s' * (starts > 1)}, {told}",
        "where they move none, the zeroing has already brought it to the boundary",
        by,
    )


class Errors(NamedTuple):
    """Sizes of the projection errors [length²] at some times [s], both of shape (n,)."""

    time: Array
    size: Array


def projection_errors(recording: Recording, paths: tuple[Path, Path]) -> Errors:
    """Return the projection errors in every `EVERY`-th frame, and at and before each switch."""
    frames = {*range(0, len(recording), EVERY), len(recording) - 1}
    for event in recording.events:
        frames |= {event.frame - 1, event.frame}
    chosen = sorted(frames)
    sizes = np.array([error_at(recording, paths, frame) for frame in chosen])
    return Errors(recording.time[chosen], sizes)


def error_at(recording: Recording, paths: tuple[Path, Path], frame: int) -> float:
    """Return the size of the projection errors in one frame [length²]."""
    assert recording.pair is not None, "not opened from a file"
    poses, places = _at(recording, paths, frame)[:2], places_at(recording, frame)
    return float(np.linalg.norm(pair_system(*recording.pair, *poses, *places).Psi))


def reset_place(body: Body, place: FeaturePlace, target: Feature) -> FeaturePlace:
    """Return where the printed reset puts a witness point, from a feature's parameters only.

    Onto an edge: at its pcurve's parameter nearest in (u, v) to the face's own. Onto a face: at the
    edge's point on its boundary. Onto an edge from a vertex: at that end.

    Raises
    ------
    ValueError
        If the features do not meet, or for a face and a vertex, which does not occur here.
    """
    source, own = place
    kinds = source.kind[0] + target.kind[0]
    if kinds == "fe":
        return target, np.array([_nearest(body, source, target, own)])
    if kinds == "ef":
        pcurve = _pcurve(body, target, source)
        return target, np.array(pcurve.point(float(own[0]))[:2], dtype=np.float64)
    if kinds == "ev":
        return target, np.empty(0)
    if kinds == "ve":
        edge = body.edge_parts[target.index]
        ends = {edge.first: edge.curve.first, edge.last: edge.curve.last}
        return target, np.array([ends[source.index]])
    raise ValueError(f"no reset from {source} to {target}")


def _pcurve(body: Body, face: Feature, edge: Feature) -> Any:
    part = body.face_parts[face.index]
    for pcurve, (index, _) in zip(part.pcurves, part.loop, strict=True):
        if index == edge.index and pcurve is not None:
            return pcurve
    raise ValueError(f"{face} has no boundary curve on {edge}")


def _nearest(body: Body, face: Feature, edge: Feature, own: Array) -> float:
    """The parameter of an edge at which its pcurve is nearest to given parameters of a face."""
    pcurve, curve = _pcurve(body, face, edge), body.edge_parts[edge.index].curve
    first, last = float(curve.first), float(curve.last)

    def at(t: float) -> Array:
        return np.array(pcurve.point(t)[:2], dtype=np.float64)

    def slope(t: float) -> float:
        step = APART * (last - first)
        return float((at(t) - own) @ (at(t + step) - at(t - step)))

    samples = np.linspace(first, last, SAMPLES + 1)
    k = int(np.argmin([np.linalg.norm(at(t) - own) for t in samples.tolist()]))
    low, high = float(samples[max(k - 1, 0)]), float(samples[min(k + 1, SAMPLES)])
    if slope(low) >= 0.0:
        return low
    return high if slope(high) <= 0.0 else float(brentq(slope, low, high, xtol=1e-15))


def _reset(
    bodies: tuple[Body, Body],
    places: BothPlaces,
    events: Iterable[RecordedEvent],
) -> BothPlaces:
    held = list(places)
    for event in events:
        k = "AB".index(event.body)
        assert held[k][0] == event.source, "each switch leaves the feature that is held"
        held[k] = reset_place(bodies[k], held[k], event.target)
    return held[0], held[1]


def _without_switches(recording: Recording, gain: float) -> Tracker:
    """The printed law of a run, without switching."""
    assert recording.pair is not None, "not opened from a file"
    dt = float(recording.time[1] - recording.time[0])
    law = PaperLaw(gain=gain, switching="none", saturation="zero", solve="plain", restarts=False)
    return Tracker(*recording.pair, dt, law=law)


def _stepped(
    tracker: Tracker, recording: Recording, paths: tuple[Path, Path], frame: int
) -> BothPlaces:
    """The witness points at the end of a frame on the features of the previous frame."""
    before, now = (_at(recording, paths, k) for k in (frame - 1, frame))
    places = places_at(recording, frame - 1)
    state = tracker.start_from(*before[:2], *places, *before[2:], settle=False)
    _, answer = tracker.step(state, *now)
    return (
        (places[0][0], np.asarray(answer.parameters_a)[: len(places[0][1])]),
        (places[1][0], np.asarray(answer.parameters_b)[: len(places[1][1])]),
    )


def _at(recording: Recording, paths: tuple[Path, Path], frame: int) -> tuple[Any, Any, Any, Any]:
    """Poses of both bodies and their twists."""
    time = float(recording.time[frame])
    a, b = paths
    return a.pose(time), b.pose(time), a.twist(time), b.twist(time)


def reset_statement(resets: list[Reset], by: str) -> Statement:
    """Return whether the projection errors at the switches are those that the resets imply."""
    off = max((reset.off for reset in resets), default=0.0)
    after = [reset.found for reset in resets] or [0.0]
    return Statement(
        "Eqs. (15)–(17)",
        "at a switch the projection errors jump by what the reset implies, and by nothing else",
        f"at all {len(resets)} frames with switches they are those of the reset's parameters to "
        f"{off:.0e} length²; they come to {max(after):.1e} at most",
        off <= ROUNDED if resets else None,
        "the law's step and the reset are computed again, without the kernels that switch",
        by,
    )


def draw_projection_errors(axes: Axes, errors: Errors, resets: list[Reset]) -> None:
    """Draw the size of the projection errors, and rings where the resets leave any."""
    drawn = np.maximum(errors.size, LEAST_DRAWN)
    axes.semilogy(errors.time, drawn, color=style.BLUE, linewidth=0.9, label="|Ψ|")
    left = [reset for reset in resets if reset.implied > LEAST_DRAWN]
    axes.semilogy(
        [reset.time for reset in left],
        [reset.implied for reset in left],
        linestyle="",
        marker="o",
        markersize=4.5,
        markerfacecolor="none",
        markeredgecolor=style.BLACK,
        markeredgewidth=0.9,
        zorder=5,
        label="|Ψ| that the reset implies",
    )


def reset_table(resets: list[Reset]) -> dict[str, list[Any]]:
    """Return the switches as a table."""
    return {
        "time_s": [reset.time for reset in resets],
        "switches": [reset.names for reset in resets],
        "psi_before_length2": [reset.before for reset in resets],
        "psi_implied_length2": [reset.implied for reset in resets],
        "psi_found_length2": [reset.found for reset in resets],
        "psi_off_length2": [reset.off for reset in resets],
    }
