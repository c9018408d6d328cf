"""A world's data, made of what its user gives."""

from __future__ import annotations

import uuid
from collections.abc import Mapping

import numpy as np

from standoff.motion import PoseLike
from standoff.tracking.law_options import Law
from standoff.world.broad_phase import Search
from standoff.world.given import BodyLike, fixed_poses_of, named_pieces
from standoff.world.model import Model
from standoff.world.packed import packed_laws, packed_pieces, pieces_of
from standoff.world.pieces import check_in_plane, dimension_of
from standoff.world.poses import check_level
from standoff.world.rules import Given, Names, check_half_spaces, packed_rules
from standoff.world.solid_pairs import solid_pairs


def made_model(
    bodies: Mapping[str, BodyLike],
    given: Given,
    at_rest: Mapping[str, PoseLike],
    within: float,
    minima: float,
    law: Law,
    dt: float,
) -> Model:
    """The data, checked; what its frames call is compiled. See `World` for what raises."""
    names = Names(tuple(bodies), given.groups)
    still = np.zeros(len(bodies), dtype=bool)
    for name in at_rest:
        still[names.body(name, "fixed")] = True
    rules = packed_rules(names, still, given)
    parts = named_pieces(bodies)
    planar = dimension_of({name: piece.body for name, piece in parts.items()}) == 2
    pieces = [pieces_of(body) for body in bodies.values()]
    fixed = tuple(name for name in bodies if name in at_rest)
    poses = fixed_poses_of(fixed, at_rest)
    if planar:
        check_level(fixed, poses, "fixed")
        check_in_plane(parts)
    check_half_spaces(list(bodies), pieces, rules)
    solids = solid_pairs(list(bodies), pieces, rules)
    tracked = np.repeat(solids.tracked, [len(each) for each in pieces]).tolist()
    reach = max(within, rules.greatest_margin)
    return Model(
        key=uuid.uuid4().hex,
        listed=tuple(bodies.items()),
        names=names,
        moving=tuple(name for name in bodies if name not in at_rest),
        fixed=fixed,
        moving_rows=np.flatnonzero(~still),
        fixed_rows=np.flatnonzero(still),
        poses_of_fixed=poses,
        planar=planar,
        minima=minima,
        search=Search(packed_pieces(pieces, planar), rules, within, reach),
        laws=packed_laws([piece for each in pieces for piece in each], law, dt, tracked),
        solids=solids,
    )
