"""Tracking by Newton's iteration on Eqs. (1)-(4), and by a point's projection on tangent planes."""

from __future__ import annotations

import numpy as np

from standoff.typing import Array
from standoff_studies.paper.field.shells import Jet, Shell, Spot, held
from standoff_studies.paper.field.support import Lost

CONVERGED = 1e-9
"""Greatest cosine between the line of the witness points and a free tangent at the end."""

BLIND_STEPS = 2
"""Steps of a frame without a test: as many evaluations as the law by the paper's integrator."""

MOST = 60
"""Iterations after which it gives up."""

Pair = tuple[Shell, Shell]
Spots = tuple[Spot, Spot]


def slopes_of(jets: list[Jet]) -> tuple[Array, Array, Array]:
    """Return x_a - x_b, the gradient of half its square, and the tangents."""
    r = jets[0].x - jets[1].x
    slope = np.concatenate([jets[0].tangents @ r, -jets[1].tangents @ r])
    return r, slope, np.concatenate([jets[0].tangents, jets[1].tangents])


def _split(shells: Pair, spots: Spots, q: Array) -> Spots:
    n = shells[0].n
    return Spot(spots[0].patch, q[:n]), Spot(spots[1].patch, q[n:])


def newton(shells: Pair, spots: Spots) -> tuple[Spots, Array]:
    """Iterate from the last places: new places, and the witness points (2, 3).

    Parameters that a step takes out of a patch stay at its side; there the patches beyond are
    evaluated once the rest has converged. H is taken as it is.
    """
    for _ in range(MOST):
        jets = [shell.jet(spot, 2) for shell, spot in zip(shells, spots, strict=True)]
        points = np.array([jet.x for jet in jets])
        new = _stepped(shells, spots, jets)
        if new is None:
            new = across(shells, spots, points)
            if new is None:
                return spots, points
        spots = new
    raise Lost("Newton's iteration did not converge")


def blind(shells: Pair, spots: Spots) -> tuple[Spots, Array]:
    """Two steps from the last places, with no test whether they are enough.

    As for the laws, the points at the answer are not counted.
    """
    for _ in range(BLIND_STEPS):
        jets = [shell.jet(spot, 2) for shell, spot in zip(shells, spots, strict=True)]
        spots = _stepped(shells, spots, jets) or spots
    points = np.array([shell.point(spot) for shell, spot in zip(shells, spots, strict=True)])
    return across(shells, spots, points) or spots, points


def _stepped(shells: Pair, spots: Spots, jets: list[Jet]) -> Spots | None:
    """The places after a step; None where those that may move have converged."""
    r, slope, tangents = slopes_of(jets)
    q = np.concatenate([spot.q for spot in spots])
    free = ~held(q, slope, tangents)
    lengths = np.linalg.norm(tangents[free], axis=1) * np.linalg.norm(r)
    if (np.abs(slope[free]) <= CONVERGED * lengths).all():
        return None
    step = np.zeros(len(q))
    hessian = hessian_of(jets, r)[np.ix_(free, free)]
    step[free] = -np.linalg.lstsq(hessian, slope[free], rcond=None)[0]
    return _split(shells, spots, np.clip(q + step, 0.0, 1.0))


def hessian_of(jets: list[Jet], r: Array) -> Array:
    """Return H, of second derivatives of half the squared distance."""
    a, b = jets
    mixed = -a.tangents @ b.tangents.T
    own_a = a.tangents @ a.tangents.T + a.bends @ r
    own_b = b.tangents @ b.tangents.T - b.bends @ r
    return np.block([[own_a, mixed], [mixed.T, own_b]])


def across(shells: Pair, spots: Spots, points: Array) -> Spots | None:
    """Return where the distance falls most over a side of either body, if it does."""
    r = points[0] - points[1]
    r = r / np.linalg.norm(r)
    best, found = CONVERGED, None
    for k, (shell, sign) in enumerate(zip(shells, (-1.0, 1.0), strict=True)):
        for other, inward in shell.beyond(spots[k]):
            fall = sign * float(inward @ r)
            if fall > best:
                best = fall
                found = (other, spots[1]) if k == 0 else (spots[0], other)
    return found


def tangent_plane(shells: Pair, spots: Spots) -> tuple[Spots, Array]:
    """Thompson's step for a point B: it is projected on the plane that touches A at the last
    witness point, and the parameters move by what that takes. One step a frame, of first order."""
    shell, spot = shells[0], spots[0]
    point = shells[1].jet(spots[1], 0).x
    at = shell.jet(spot, 1)
    slope = at.tangents @ (at.x - point)
    free = ~held(spot.q, slope, at.tangents)
    step = np.zeros(shell.n)
    if free.any():
        step[free] = np.linalg.lstsq(at.tangents[free].T, point - at.x, rcond=None)[0]
    new = Spot(spot.patch, np.clip(spot.q + step, 0.0, 1.0))
    points = np.array([shell.jet(new, 0).x, point])
    return across(shells, (new, spots[1]), points) or (new, spots[1]), points
