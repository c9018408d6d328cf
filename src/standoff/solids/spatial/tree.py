"""The tree over a solid's leaves, and all of it in two flat arrays."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.boundary import Boundary
from standoff.bodies.face_leaves import face_charts
from standoff.bodies.packed_parts import PackedParts
from standoff.geometry.patch_bounds import between
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.torus_potential import TORUS_THROUGH
from standoff.solids.spatial.analytic import natural_of
from standoff.solids.spatial.corners import check_corners, check_creases
from standoff.solids.spatial.edge_kinds import proven_kinds, sampled_edges
from standoff.solids.spatial.leaves import (
    Leaf,
    box_of,
    edge_cones,
    edge_leaves,
    face_leaves,
    parts_of_edge,
    vertex_leaf,
)
from standoff.solids.spatial.screws import put_screws
from standoff.solids.spatial.tolerances import CONE_ROUNDINGS, NO_AXIS
from standoff.solids.spatial.trims import CoedgePiece, columns_of, pieces_of
from standoff.typing import Array

CORNERS = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)], dtype=float)


class _Node:
    def __init__(self, leaves: list[int]) -> None:
        self.leaves = leaves
        self.left = self.right = -1
        self.reals = np.zeros(S.NODE_REALS)


def all_leaves(boundary: Boundary) -> tuple[list[Leaf], list[CoedgePiece], tuple[int, ...]]:
    """All leaves of a boundary, the pieces of its trimming curves, and the edges whose kind only
    samples decide."""
    charts = {c.number: c for c in face_charts(boundary)}
    pieces = pieces_of(boundary, charts)
    own: dict[int, list[int]] = {number: [] for number in charts}
    for k, piece in enumerate(pieces):
        own[piece.chart].append(k)
    found = [
        leaf
        for number, chart in charts.items()
        for leaf in face_leaves(boundary, chart, pieces, own[number], boundary.size)
    ]
    check_creases({number: (chart.face, chart.surface) for number, chart in charts.items()}, found)
    columns = columns_of(pieces)
    kinds = proven_kinds(boundary, charts, pieces, columns)
    sampled = sampled_edges(kinds, boundary.edge_kinds)
    ranges = {k: parts_of_edge(boundary, k) for k in range(boundary.n_edges)}
    check_corners({k: boundary.edge_parts[k].curve for k, parts in ranges.items() if parts})
    cones = edge_cones(charts, columns, ranges)
    round_faces = {}
    natural = {number: natural_of(chart) for number, chart in charts.items()}
    for piece in pieces:
        kind, record = natural[piece.chart]
        if kind > TORUS_THROUGH:
            round_faces[piece.edge] = kind, record
    for number, parts in ranges.items():
        if parts:
            beside = round_faces.get(number, (-1, np.zeros(9)))
            proven = number not in sampled
            found += edge_leaves(boundary, number, parts, cones[number], beside, proven)
    beside_edges: dict[int, list[int]] = {boundary.n_faces + piece.edge: [] for piece in pieces}
    for piece in pieces:
        beside_edges[boundary.n_faces + piece.edge].append(piece.chart)
    put_screws(found, charts, beside_edges)
    found += [vertex_leaf(boundary, number) for number in range(boundary.n_vertices)]
    return found, pieces, sampled


class Packed(NamedTuple):
    """A solid's leaves and tree, laid out as in ``kernels.solids.spatial_layout``."""

    own: NDArray[np.int64]
    numbers: Array
    leaves: list[Leaf]
    edges_sampled: tuple[int, ...]


def packed_leaves(boundary: Boundary, faces: tuple[int, ...] = ()) -> Packed:
    """The leaves of a boundary and the tree over them; of some faces, without their edges, where
    `faces` names these."""
    leaves, pieces, sampled = all_leaves(boundary)
    if faces:
        leaves = [leaf for leaf in leaves if leaf.dim == 2 and leaf.feature in faces]
    nodes = _grown(leaves)
    ints, reals = list(range(S.INT_HEADER)), np.zeros(S.REAL_HEADER)
    lists: list[int] = []
    leaf_rows: list[int] = []
    leaf_reals: list[Array] = []
    for leaf in leaves:
        place = len(lists) if leaf.dim == 2 else leaf.beside
        leaf_rows += [leaf.dim, leaf.feature, leaf.chart, int(leaf.cut), leaf.senses, place]
        leaf_rows += [len(leaf.pieces), leaf.kind]
        lists += leaf.pieces
        leaf_reals.append(leaf.reals)
    node_rows = [n for node in nodes for n in (node.left, node.right,
                 node.leaves[0] if len(node.leaves) == 1 else -1)]  # fmt: skip
    piece_rows = [n for p in pieces for n in (p.coedge, _feature(boundary, p))]
    ints[S.N_LEAVES], ints[S.N_NODES] = len(leaves), len(nodes)
    ints[S.LEAVES] = S.INT_HEADER
    ints[S.NODES] = ints[S.LEAVES] + len(leaf_rows)
    ints[S.PIECES] = ints[S.NODES] + len(node_rows)
    ints[S.LISTS] = ints[S.PIECES] + len(piece_rows)
    blocks = [
        np.concatenate(leaf_reals),
        np.concatenate([node.reals for node in nodes]),
        np.array([_piece_reals(p) for p in pieces]).ravel(),
    ]
    ints[S.R_LEAVES] = S.REAL_HEADER
    ints[S.R_NODES] = ints[S.R_LEAVES] + len(blocks[0])
    ints[S.R_PIECES] = ints[S.R_NODES] + len(blocks[1])
    packed = np.array([*ints, *leaf_rows, *node_rows, *piece_rows, *lists], dtype=np.int64)
    numbers = np.concatenate([reals, *blocks])
    packed.flags.writeable = numbers.flags.writeable = False
    return Packed(packed, numbers, leaves, sampled)


def _feature(boundary: PackedParts, piece: CoedgePiece) -> int:
    if piece.edge >= 0:
        return boundary.n_faces + piece.edge
    return boundary.n_faces + boundary.n_edges - 1 - piece.edge


def _piece_reals(p: CoedgePiece) -> list[float]:
    return [p.first, p.last, p.low[0], p.high[0], p.low[1], p.high[1], *p.bend, p.shift, *p.bounds,
            0.0]  # fmt: skip


def _grown(leaves: list[Leaf]) -> list[_Node]:
    """A binary tree of boxes, its root first."""
    centres = np.array([leaf.centre for leaf in leaves])
    corners = np.array([leaf.centre + (CORNERS * leaf.half) @ leaf.axes for leaf in leaves])
    seen = np.array([leaf.reals[S.CONE_OUT : S.CONE_OUT + 8] for leaf in leaves])
    nodes = [_Node(list(range(len(leaves))))]
    at = 0
    while at < len(nodes):
        node = nodes[at]
        at += 1
        own = node.leaves
        if len(own) == 1:
            leaf = leaves[own[0]]
            node.reals[:] = [*leaf.centre, *leaf.axes.ravel(), *leaf.half,
                             *leaf.reals[S.CONE_OUT : S.CONE_OUT + 8]]  # fmt: skip
            continue
        spots = corners[own].reshape(-1, 3)
        axes = _axes_of(spots)
        heights = spots @ axes.T
        centre, axes, half = box_of(axes, heights.min(axis=0), heights.max(axis=0))
        cones = [_cone_round(part) for part in np.split(seen[own], 2, axis=1)]
        node.reals[:] = [*centre, *axes.ravel(), *half, *cones[0], *cones[1]]
        middle = centres[own] @ axes.T
        order = np.argsort(middle[:, int(np.ptp(middle, axis=0).argmax())], kind="stable")
        half_way = len(own) // 2
        sorted_own = [own[k] for k in order]
        node.left, node.right = len(nodes), len(nodes) + 1
        nodes += [_Node(sorted_own[:half_way]), _Node(sorted_own[half_way:])]
    return nodes


def _axes_of(spots: Array) -> Array:
    """Along the coordinate axes or the principal ones, whichever box is smaller."""
    _, turned = np.linalg.eigh(np.cov((spots - spots.mean(axis=0)).T))
    options = [np.eye(3), turned.T if np.linalg.det(turned) > 0 else -turned.T]
    sizes = [float(np.linalg.norm(np.ptp(spots @ axes.T, axis=0))) for axes in options]
    return options[int(np.argmin(sizes))]


def _cone_round(cones: Array) -> list[float]:
    """A cone round several, (n, 4); a half angle of -1: none has any normal."""
    known = cones[cones[:, 3] >= 0.0]
    if not len(known):
        return [0.0, 0.0, 1.0, -1.0]
    axis = known[:, :3].sum(axis=0)
    size = float(np.linalg.norm(axis))
    if size <= NO_AXIS or known[:, 3].max() >= np.pi:
        return [0.0, 0.0, 1.0, np.pi]
    axis = axis / size
    reach = float((between(axis[:, None], known[:, :3].T) + known[:, 3]).max()) + CONE_ROUNDINGS
    return [*axis, reach if reach < np.pi else np.pi]
