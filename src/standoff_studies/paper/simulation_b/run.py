"""Simulation B's motion, tracked by the paper's law from wrong starts and by the library's own."""

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
from standoff.tracking.laws import PaperLaw
from standoff_studies.paper.bodies import planar_body

Array = NDArray[np.float64]

DURATION = 4.0
"""Of the motion [s]."""
FRAME = 1e-3
"""From frame to frame [s]: the paper's 1 kHz."""
SNAPSHOTS = 100
"""Frames of Fig. 10: one every 40 ms."""

RATE = 2.0 * math.pi
"""Of the point about the origin: a turn a second [rad/s]."""
RADIUS = 0.06
"""Of the spiral at the start [length]: near the middle, where all curves are as far."""
PAST = 0.002
"""By which the spiral passes vertex 1 in its third turn [length]: so near that one frame goes
through the vertex's region."""

GAIN = 25.0
"""K of the paper's law [1/s]: low, so that the snapshots show the start converge."""
WRONG_START = (0.95, 0.05, 0.05)
"""Parameters of the curves at the start; they should be near 0.5."""
OTHER_STARTS = ((0.05, 0.95, 0.95), (1.0, 0.0, 1.0))
"""Starts from which the instants must be the same."""
CONVERGED = 0.6
"""When the starts have converged [s]: e^(−K t) is 3e-7."""

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
    paper : PointRecording
        By the paper's law (Heun, `GAIN`, switching as printed) from `WRONG_START`.
    others : tuple of PointRecording
        The same from `OTHER_STARTS`.
    exact : PointRecording
        By the library's own law, certified.
    snapshots : ndarray of int, shape (SNAPSHOTS,)
        Frames of Fig. 10.
    """

    body: Body
    regions: VoronoiRegions
    path: Spiral
    paper: PointRecording
    others: tuple[PointRecording, ...]
    exact: PointRecording
    snapshots: NDArray[np.int64]


def motion(body: Body) -> Spiral:
    """Return the point's spiral: it passes vertex 1 just outside in its third turn."""
    corner = body.vertex_points[1]
    turned = 2.0 * 2.0 * math.pi + math.atan2(corner[1], corner[0])
    growth = (math.hypot(corner[0], corner[1]) + PAST - RADIUS) / turned
    return Spiral(RADIUS, growth, RATE)


@cache
def run() -> Run:
    """Return the simulation, computed once."""
    body = planar_body()
    path, regions = motion(body), voronoi_regions(body)
    times = np.asarray(FRAME * np.arange(round(DURATION / FRAME) + 1), dtype=np.float64)
    paper = from_wrong_start(body, path, times, WRONG_START)
    others = [from_wrong_start(body, path, times, start, math.inf) for start in OTHER_STARTS]
    exact = record_point(PointTracker(body, FRAME), path, times)
    snapshots = np.arange(SNAPSHOTS) * round(DURATION / FRAME / SNAPSHOTS)
    return Run(body, regions, path, paper, tuple(others), exact, snapshots)


def from_wrong_start(
    body: Body, path: Spiral, times: Array, start: tuple[float, ...], tolerance: float = 1e-10
) -> PointRecording:
    """Track the point by the paper's law from given parameters; without a finite tolerance the
    answers are not certified, which takes less time."""
    tracker = PointTracker(
        body, FRAME, law=PaperLaw(gain=GAIN, switching="voronoi", tolerance=tolerance)
    )
    x, v = path.pose(float(times[0])).translation, path.twist(float(times[0])).v
    return record_point(tracker, path, times, tracker.start_from(x, start, v))


def late(recording: PointRecording) -> list[PointEvent]:
    """Return the switches after the starts have converged."""
    return [event for event in recording.events if event.time > CONVERGED]


def brute_modes(body: Body, points: Array) -> list[str]:
    """Return the nearest feature of each point, (n, 2), by dense samples of all curves.

    "C0" and the like for a curve, "V0" for a vertex.
    """
    curves = [part.curve for part in body.edge_parts]
    parameters = [np.linspace(c.first, c.last, DENSE) for c in curves]
    samples = np.array(
        [[c.point(t)[:2] for t in own] for c, own in zip(curves, parameters, strict=True)]
    )
    found = []
    for point in points:
        far = np.linalg.norm(samples - point, axis=2)
        curve, k = (int(i) for i in np.unravel_index(far.argmin(), far.shape))
        at_end = k in (0, DENSE - 1)
        found.append(f"V{(curve + (k > 0)) % len(curves)}" if at_end else f"C{curve}")
    return found


def psi(recording: PointRecording, curve: int) -> Array:
    """Return the projection error of one curve's tracker by frame [length²], shape (n,)."""
    path = recording.body.edge_parts[curve].curve
    speed = [np.linalg.norm(path.jet(t)[1]) for t in recording.curve_parameter[:, curve].tolist()]
    return np.asarray(recording.curve_residual[:, curve] * np.array(speed))


def decay(recording: PointRecording, curve: int, first: float, last: float) -> float:
    """Return the rate of decay of a curve's projection error between two times [1/s]."""
    error = psi(recording, curve)
    ends = [int(np.searchsorted(recording.time, t - 0.5 * FRAME)) for t in (first, last)]
    return float(np.log(error[ends[0]] / error[ends[1]]) / (last - first))
