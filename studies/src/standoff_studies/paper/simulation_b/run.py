"""Simulation B's motion, by the printed system from wrong starts and by the library's own law."""

from __future__ import annotations

import math
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies import Body
from standoff.bodies.voronoi import VoronoiRegions, voronoi_regions
from standoff.motion import Spiral
from standoff.points import PointEvent, PointRecording, PointTracker, record_point
from standoff.tracking import Feature
from standoff.typing import Array
from standoff_studies.paper.bodies import planar_body
from standoff_studies.paper.drawing import curve_points
from standoff_studies.paper.law_words import law_words
from standoff_studies.paper.many_starts import Ends, last_answers
from standoff_studies.paper.pair_simulation import REST
from standoff_studies.paper.simulation_b.printed import Printed, PrintedRun

DURATION = 4.0
"""Duration of the motion [s]."""
FRAME = 1e-3
"""Time from frame to frame [s]: the paper's 1 kHz."""
SNAPSHOTS = 100
"""Frames of Fig. 10: one every 40 ms."""

RATE = 2.0 * math.pi
"""Angular velocity of the point about the origin: one turn per second [rad/s]."""
RADIUS = 0.06
"""Radius of the spiral at the start [length]: near the middle, equally far from all curves."""
PAST = 0.002
"""Distance at which the spiral passes vertex 1 in its third turn [length]: so small that one frame
goes through the vertex's region."""

GAIN = 25.0
"""K of the paper's law [1/s]: low, so that the snapshots show the start converge."""
WRONG_START = (0.95, 0.05, 0.05)
"""Parameters of the curves at the start; they should be near 0.5."""
OTHER_STARTS = ((0.05, 0.95, 0.95), (1.0, 0.0, 1.0))
"""Starts from which the instants must be the same."""
CONVERGED = 0.6
"""When the starts have converged [s]: e^(−K t) is 3e-7."""

NO_LAW = "so.voronoi_regions, before the run: no law"

TRIED = 41
"""Number of starts tried on each curve, from end to end."""
ARRIVED = 1e-3
"""Greatest error of the distance to the curve at `CONVERGED` of one that arrives [length]."""

DENSE = 2001
"""Points of each curve in the brute-force search."""


class Run(NamedTuple):
    """The simulation.

    Attributes
    ----------
    body : Body
        At rest at home.
    regions : VoronoiRegions
    path : Spiral
        Of the point.
    printed : Printed
        What runs the printed system from a start.
    paper : PrintedRun
        By the printed system at the low `GAIN` from `WRONG_START`. All figures show it.
    others : tuple of PrintedRun
        The same from `OTHER_STARTS`.
    exact : PointRecording
        By the library's own law, certified.
    own : str
        The law with which statements on it were measured.
    snapshots : ndarray of int, shape (SNAPSHOTS,)
        Frames of Fig. 10.
    """

    body: Body
    regions: VoronoiRegions
    path: Spiral
    printed: Printed
    paper: PrintedRun
    others: tuple[PrintedRun, ...]
    exact: PointRecording
    own: str
    snapshots: NDArray[np.int64]


@cache
def motion(body: Body) -> Spiral:
    """Return the point's spiral: it passes vertex 1 just outside in its third turn."""
    corner = body.vertex_points[1]
    turned = 2.0 * 2.0 * math.pi + math.atan2(corner[1], corner[0])
    growth = (math.hypot(corner[0], corner[1]) + PAST - RADIUS) / turned
    return Spiral(RADIUS, growth, RATE)


@cache
def shape() -> tuple[Body, VoronoiRegions]:
    """Return the body and its regions."""
    body = planar_body()
    return body, voronoi_regions(body)


def frame_times() -> Array:
    """Return the times of the frames [s]."""
    return np.asarray(FRAME * np.arange(round(DURATION / FRAME) + 1), dtype=np.float64)


@cache
def exact_run() -> tuple[PointRecording, str]:
    """Track the point with the library's own law; return also the words for that law."""
    body, _ = shape()
    tracker = PointTracker(body, FRAME)
    return record_point(tracker, motion(body), frame_times()), law_words(tracker)


@cache
def run() -> Run:
    """Return the simulation, computed once."""
    (body, regions), (exact, own) = shape(), exact_run()
    path, times = motion(body), frame_times()
    printed = Printed(body, regions, path, times, GAIN)
    paper, *others = (printed.run(start) for start in (WRONG_START, *OTHER_STARTS))
    snapshots = np.arange(SNAPSHOTS) * round(DURATION / FRAME / SNAPSHOTS)
    return Run(body, regions, path, printed, paper, tuple(others), exact, own, snapshots)


@cache
def arrivals() -> Ends:
    """Try starts all over each curve: each of the parallel trackers is alone on its curve."""
    simulation = run()
    printed, k, found = simulation.printed, round(CONVERGED / FRAME), 0
    paths, times = (REST, simulation.path), printed.times[: k + 1]
    for curve in range(simulation.body.n_edges):
        due = simulation.exact.curve_distance[k, curve]
        states = (
            printed.begun(printed.parallel, Feature("edge", curve), u, 0)
            for u in np.linspace(0.0, 1.0, TRIED).tolist()
        )
        last = last_answers(printed.parallel, states, paths, times)
        found += sum(bool(abs(answer.distance - due) < ARRIVED) for answer in last)
    by = law_words(printed.parallel, told="starts along each curve")
    return Ends(found, TRIED * simulation.body.n_edges, by)


def late(recording: PointRecording | PrintedRun) -> list[PointEvent]:
    """Return the switches after the starts have converged."""
    return [event for event in recording.events if event.time > CONVERGED]


def off_instants(simulation: Run) -> dict[str, float]:
    """Return how far switches are from those of the library's own law, by their kind [s].

    Infinite if the features differ.
    """
    ours, due = simulation.paper.events, simulation.exact.events
    if [event[1:4] for event in ours] != [event[1:4] for event in due]:
        return dict.fromkeys(("medial", "crossing", "voronoi"), math.inf)
    off: dict[str, float] = {}
    for one, other in zip(ours, due, strict=True):
        off[one.kind] = max(off.get(one.kind, 0.0), abs(one.time - other.time))
    return off


def brute_modes(body: Body, points: Array) -> list[str]:
    """Return the nearest feature of each point, (n, 2), by dense samples of all curves.

    "C0" and the like for a curve, "V0" for a vertex.
    """
    samples = np.array([curve_points(body, k, count=DENSE) for k in range(body.n_edges)])
    found = []
    for point in points:
        far = np.linalg.norm(samples - point, axis=2)
        curve, k = (int(i) for i in np.unravel_index(far.argmin(), far.shape))
        at_end = k in (0, DENSE - 1)
        found.append(f"V{(curve + (k > 0)) % len(samples)}" if at_end else f"C{curve}")
    return found


def psi(recording: PrintedRun, curve: int) -> Array:
    """Return the projection error of one curve's tracker by frame [length²], shape (n,)."""
    path = recording.body.edge_parts[curve].curve
    found = np.full(len(recording), np.nan)
    for k in np.flatnonzero(np.isfinite(recording.curve_parameter[:, curve])).tolist():
        c, tangent, _ = path.jet(float(recording.curve_parameter[k, curve]))
        found[k] = tangent @ (c - recording.point[k])
    return found


def decay(recording: PrintedRun, curve: int, first: float, last: float) -> float:
    """Return the rate of decay of a curve's projection error between two times [1/s]."""
    error = np.abs(psi(recording, curve))
    ends = [int(np.searchsorted(recording.time, t - 0.5 * FRAME)) for t in (first, last)]
    return float(np.log(error[ends[0]] / error[ends[1]]) / (last - first))
