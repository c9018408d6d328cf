"""Other packages' answers for a pair of ellipsoids, given by their semi-axes.

The packages' adaptors are `standoff_studies.accuracy.peers`; each is imported only when it is used
(``pip install standoff-studies[peers]``).
"""

from __future__ import annotations

from collections.abc import Callable

from standoff_studies.accuracy.peers.answer import Array, Peer, PeerAnswer, Pose, Query
from standoff_studies.accuracy.peers.coal_peer import Coal, coal_request
from standoff_studies.accuracy.peers.mujoco_peer import MuJoCo
from standoff_studies.accuracy.solids import Solid, named

__all__ = [
    "PEERS",
    "Array",
    "PeerAnswer",
    "Pose",
    "Query",
    "coal_ellipsoids",
    "coal_request",
    "mujoco_ellipsoids",
]


def _query(peer: Peer, semi_axes_a: Array, semi_axes_b: Array) -> Query:
    (kind,) = named(["ellipsoid"])
    a, b = (
        Solid(kind, dict(zip("abc", map(float, axes), strict=True)))
        for axes in (semi_axes_a, semi_axes_b)
    )
    query = peer.query(a, b)
    assert query is not None
    return query


def coal_ellipsoids(semi_axes_a: Array, semi_axes_b: Array, tight: bool = False) -> Query:
    """Return a query of Coal for two ellipsoids of semi-axes (3,).

    ``tight``: the tightest tolerance that pays in place of Coal's defaults (1e-6).

    Raises
    ------
    ImportError
        Coal is not installed.
    """
    return _query(Coal(tight), semi_axes_a, semi_axes_b)


def mujoco_ellipsoids(semi_axes_a: Array, semi_axes_b: Array, tight: bool = True) -> Query:
    """Return a query of MuJoCo for two ellipsoids of semi-axes (3,).

    ``tight``: the tightest tolerance that pays in place of MuJoCo's defaults (1e-6).

    Raises
    ------
    ImportError
        MuJoCo is not installed.
    """
    return _query(MuJoCo(tight), semi_axes_a, semi_axes_b)


PEERS: dict[str, Callable[[Array, Array], Query]] = {
    "Coal, default": lambda a, b: coal_ellipsoids(a, b),
    "Coal, tight": lambda a, b: coal_ellipsoids(a, b, tight=True),
    "MuJoCo, default": lambda a, b: mujoco_ellipsoids(a, b, tight=False),
    "MuJoCo, tight": lambda a, b: mujoco_ellipsoids(a, b),
}
"""Name of each peer and setting: a function of both semi-axes that returns a query."""
