"""A world's pieces as the kernels read them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from standoff.bodies.body import Body
from standoff.bodies.planes import outer_plane
from standoff.kernels.state import arrays as K
from standoff.kernels.world import arrays as W
from standoff.motion import Pose
from standoff.tracking.law_options import Law
from standoff.tracking.laws import PaperLaw
from standoff.tracking.reached import reach
from standoff.tracking.specialised import kinds_of, main_kind
from standoff.typing import Array, Ints
from standoff.world.pieces import CompoundPiece, PieceUnion
from standoff.world.shapes import Shape, box_of, dimension_of_shape, is_bounded


class PackedPieces(NamedTuple):
    """What does not change from frame to frame.

    Attributes
    ----------
    owners : (n,) array
        The body of each piece.
    first : (n_bodies + 2,) array
        The first piece of each body, how many pieces there are, and how many a body has at most.
    planes : (n,) array
        1 for a half-space.
    facts : (n, N_FACT) array
    """

    owners: Ints
    first: Ints
    planes: Ints
    facts: Array


def pieces_of(body: Shape | PieceUnion) -> tuple[CompoundPiece, ...]:
    """Those of a compound, or a body as the only one."""
    if isinstance(body, PieceUnion):
        return tuple(body.pieces.values())
    return (CompoundPiece(body, Pose.identity()),)


def packed_pieces(bodies: Sequence[Sequence[CompoundPiece]], planar: bool = False) -> PackedPieces:
    """Of the pieces of all bodies, of a planar world or of a spatial one."""
    counts = [len(pieces) for pieces in bodies]
    owners = np.repeat(np.arange(len(bodies)), counts)
    first = np.concatenate([[0], np.cumsum(counts), [max(counts)]]).astype(np.int64)
    known: dict[int, Array] = {}
    facts = np.empty((len(owners), W.N_FACT))
    for row, piece in zip(facts, (p for pieces in bodies for p in pieces), strict=True):
        body = piece.body
        if id(body) not in known:
            known[id(body)] = _facts(body)
        row[:] = known[id(body)]
        _place(row, piece.pose, planar)
    planes = facts[:, W.F_PLANE].astype(np.int64)
    packed = PackedPieces(owners.astype(np.int64), first, planes, facts)
    for array in packed:
        array.flags.writeable = False
    return packed


def _facts(shape: Shape) -> Array:
    """A piece's row without its placement."""
    row = np.zeros(W.N_FACT)
    centre, half, row[W.F_RADIUS] = box_of(shape)
    row[W.F_PLANAR] = 1.0 if dimension_of_shape(shape) == 2 else 0.0
    if not is_bounded(shape):
        row[W.F_PLANE] = 1.0
        normal, offset = outer_plane(shape)
        row[W.F_NORMAL : W.F_NORMAL + 3], row[W.F_OFFSET] = normal, offset
        return row
    row[W.F_CENTRE : W.F_CENTRE + 3] = centre
    row[W.F_HALF : W.F_HALF + 3] = half
    row[W.F_REACH] = np.linalg.norm(half) * (1.0 + 8.0 * np.finfo(float).eps)
    return row


def _place(row: Array, pose: Pose, planar: bool) -> None:
    row[W.F_ROTATION : W.F_SHIFT] = pose.rotation.ravel()
    row[W.F_SHIFT : W.F_PLACED] = pose.translation
    identity = np.array_equal(pose.rotation, np.eye(3)) and not pose.translation.any()
    placed = W.LEVEL if planar else W.PLACED
    row[W.F_PLACED] = 0.0 if identity else placed


class PackedLaws(NamedTuple):
    """What the frames of all pairs read.

    Attributes
    ----------
    addresses : (n, 4) array
        Where each piece's arrays lie.
    classes : (n,) array
        The class of each piece, by the kinds of its faces.
    options : (k, k, N_OPTIONS) array
        Of each pair of classes, with the addresses of its frames.
    integrates : bool
        Is the law integrated from each frame to the next, so that none may be left out?
    """

    addresses: Ints
    classes: Ints
    options: Array
    integrates: bool


UNREAD: tuple[list[int], int] = [0, 0, 0, 0], 0


def packed_laws(
    pieces: Sequence[CompoundPiece], law: Law, dt: float, tracked: Sequence[bool]
) -> PackedLaws:
    """Of all pieces, in their order; nothing of those that no frame reads, as none of their pairs
    is tracked."""
    classes: dict[Any, int] = {}
    examples: list[Body] = []
    known: dict[int, tuple[list[int], int]] = {}
    for piece, read in zip(pieces, tracked, strict=True):
        body = piece.body
        if id(body) in known or not (read and isinstance(body, Body)):
            continue
        kind = main_kind(body), len(kinds_of(body)) > 1, body.bounded
        if kind not in classes:
            classes[kind] = len(classes)
            examples.append(body)
        lies = [body.ints.ctypes.data, len(body.ints), body.reals.ctypes.data, len(body.reals)]
        known[id(body)] = lies, classes[kind]
    rows = [known.get(id(piece.body), UNREAD) for piece in pieces]
    options = np.zeros((max(len(examples), 1),) * 2 + (K.N_OPTIONS,))
    for i, a in enumerate(examples):
        for j, b in enumerate(examples):
            options[i, j] = _options(a, b, law, dt)
    found = PackedLaws(
        np.array([lies for lies, _ in rows], dtype=np.int64),
        np.array([number for _, number in rows], dtype=np.int64),
        options,
        isinstance(law, PaperLaw),
    )
    for array in found[:3]:
        array.flags.writeable = False
    return found


def _options(a: Body, b: Body, law: Law, dt: float) -> Array:
    """The options of a pair of classes; two half-spaces are no pair, and have a body's."""
    if not a.bounded and not b.bounded:
        return np.zeros(K.N_OPTIONS)
    # the world has the horizon: a frame that it asks for is made
    return reach(a, b, replace(law, within=None), dt, None).options
