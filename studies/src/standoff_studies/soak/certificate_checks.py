"""What must hold for every answer of the certificate for a pair with known distance."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from standoff.kernels.body import layout as L
from standoff.kernels.pair.certified import CERTIFIED
from standoff.kernels.state.arrays import N_MOTION
from standoff.kernels.tolerances import BLUR, DEPTH_PROOF, EPS, START_GAP, TOUCHING
from standoff.tracking.status import Status
from standoff.typing import Array
from standoff_studies.oracles import HalfSpace, lengths
from standoff_studies.soak import any_places as P
from standoff_studies.soak.checks import BLURRED, BOX_CENTRE, LEAST, ON_BODY, ROUNDOFF
from standoff_studies.soak.known_gaps import Scene
from standoff_studies.soak.placing import heights, to_world
from standoff_studies.soak.tally import Tally

Rng = np.random.Generator

SQUARE = 1e-9
"""How far a normal on an edge may be from perpendicular to it (dimensionless): the roundoff of the
ends of an edge that is a millionth of its body's size."""

UNIT = 1e-14
"""By how much a hint's length may differ from 1 for it to count as a unit vector."""


class Miss(NamedTuple):
    """A failed check: the case of a scene, the value, and what is allowed."""

    case: int
    what: str
    value: float
    allowed: float


def ask_all(scene: Scene, drawn: Array) -> Array:
    """Query a scene in every case of `drawn`, (n, N_DRAWN); rows (n, N_ASKED)."""
    asked = np.empty((len(drawn), P.N_ASKED))
    motion = np.zeros(N_MOTION)
    motion[:12], motion[12:24] = scene.pose_a, scene.pose_b
    a, b = scene.a.body, scene.b.body
    P.ask(a.ints, a.reals, b.ints, b.reals, motion, scene.normal, drawn, asked)
    return asked


def size_of(scene: Scene, asked: Array) -> Array:
    """Lengths to which roundoff is relative, (n,)."""
    bodies = [one.body for one in (scene.a, scene.b) if one.body.bounded]
    sizes = sum(b.size + b.radius + float(np.linalg.norm(b.reals[BOX_CENTRE])) for b in bodies)
    away = np.linalg.norm(scene.pose_a[9:]) + np.linalg.norm(scene.pose_b[9:])
    return np.asarray(np.maximum(sizes + away + np.abs(np.nan_to_num(asked[:, P.D])), LEAST))


def separations(scene: Scene, asked: Array) -> Array:
    """-s(n), (n,), along the normals that the certificate returns; inf where it returns none.

    With a half-space it is finite only along its own normal: it is then the scene's true distance.
    """
    told = asked[:, P.NORMAL : P.NORMAL + 3]
    named = lengths(told) > 0.5
    if isinstance(scene.a.support, HalfSpace) or isinstance(scene.b.support, HalfSpace):
        return np.full(len(asked), np.inf)
    n = to_world(np.broadcast_to(scene.pose_a, (len(told), 12)), told)
    n[~named] = scene.normal
    n /= lengths(n)[:, None]
    up = heights(scene.a, np.broadcast_to(scene.pose_a, (len(n), 12)), n)[0]
    down = heights(scene.b, np.broadcast_to(scene.pose_b, (len(n), 12)), -n)[0]
    return np.where(named, -(up + down), np.inf)


def worst(what: str, over: Array, limit: Array | float, where: Any = True) -> Iterator[Miss]:
    """The case that exceeds the allowed value most, or is not a number; empty if all are fine."""
    wrong = ~(over <= limit) & where
    if wrong.any():
        beyond = np.where(wrong, np.nan_to_num(over - limit, nan=np.inf), -np.inf)
        k = int(beyond.argmax())
        yield Miss(k, what, float(over[k]), float(np.broadcast_to(limit, over.shape)[k]))


def misses(scene: Scene, asked: Array) -> Iterator[Miss]:
    """Check every answer of a scene; return the worst case of each failed check."""
    a, b = scene.a.body, scene.b.body
    radii, truth = a.radius + b.radius, scene.truth
    noise = ROUNDOFF * size_of(scene, asked)
    slack = a.reals[L.SLACK] + b.reals[L.SLACK]
    d, lower, on = asked[:, P.D] - radii, asked[:, P.LOWER] - radii, asked[:, P.ON] > 0.5
    along = asked[:, P.HOW] >= P.ALONG
    certified = asked[:, P.OUTCOME] == CERTIFIED
    status, told = asked[:, P.STATUS], asked[:, P.TOLERANCE]
    goal = np.where(np.isinf(told), START_GAP, told) * asked[:, P.SPAN]
    blur = np.minimum(asked[:, P.BLUR], BLUR * asked[:, P.SPAN])
    allowed = goal + slack + blur + noise
    # a point may be past its face's boundary, as witness points of the soak may
    shares = slack + ON_BODY / ROUNDOFF * noise

    yield from worst("a bound that is not a number", np.isnan(lower) * 1.0, 0.0)
    yield from worst("a distance that is not finite", 1.0 * ~np.isfinite(d), 0.0)
    # callers of a direction have checked where the points are; `weigh` must do so itself
    asked_of = on | ~along
    yield from worst("the lower bound is above the distance", lower - truth, noise, asked_of)
    yield from worst(
        "the lower bound is above what its normal separates",
        lower - separations(scene, asked),
        noise,
        asked_of,
    )
    yield from worst(
        "points of the bodies nearer than the distance", truth - d, shares, on & ~along
    )
    off = np.abs(d - truth)
    yield from worst("certified at a wrong distance", off, allowed, certified & np.isfinite(told))
    apart = status == Status.CONVERGED.value
    yield from worst("CONVERGED at a wrong distance", off, allowed, apart)
    proven = status == Status.GLOBAL.value
    loose = allowed + DEPTH_PROOF * np.abs(d) + TOUCHING * asked[:, P.SPAN]
    yield from worst("GLOBAL at a wrong depth", off, loose, proven)
    yield from worst("a point off its face is certified", 1.0 * certified, 0.0, ~on)
    if not {scene.a.shape.kind, scene.b.shape.kind} & BLURRED:
        yield from worst("a normal not perpendicular to its edge", asked[:, P.NEAREST], SQUARE)


def count(tally: Tally, scene: Scene, asked: Array) -> None:
    """Count the cases, and those that proved something."""
    certified = asked[:, P.OUTCOME] == CERTIFIED
    radii = scene.a.body.radius + scene.b.body.radius
    tally.count("certificates", len(asked))
    tally.count(f"certificates of a {scene.where} pair", len(asked))
    tally.count("certificates that prove a distance", certified.sum())
    tally.count("certificates off a face", (asked[:, P.ON] < 0.5).sum())
    over = (asked[:, P.LOWER] - radii - scene.truth) / size_of(scene, asked)
    asked_of = (asked[:, P.ON] > 0.5) | (asked[:, P.HOW] < P.ALONG)
    highest = over[np.isfinite(over) & asked_of].max(initial=-1.0)
    tally.note("a certificate's bound above the distance, over size, in eps", highest / EPS)
