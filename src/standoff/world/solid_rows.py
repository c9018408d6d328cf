"""The pairs with a solid in a frame: tracked where they were near before, else asked from nothing;
what was found is kept while they rest.

Bounds that were known go on holding by the ways of the pieces only while they are positive: how
deep solids are in each other is not known to change by no more than they move. So a pair whose
bound is not positive is asked again wherever it has moved.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from standoff.kernels.state import arrays as K
from standoff.kernels.world import arrays as W
from standoff.motion import Pose
from standoff.motion.vectors import pose_row
from standoff.solids.answer import Overlap, SolidProximity
from standoff.solids.inner_ball import ball_inside
from standoff.solids.of_pieces import OfPieces, answer_of_pieces
from standoff.solids.query import distance
from standoff.solids.spatial.half_space import size_together
from standoff.solids.spatial.tolerances import PROOF_TOLERANCE
from standoff.solids.tracked.front import KeptFront, moved_by
from standoff.solids.tracked.state import SolidState
from standoff.solids.tracked.tracker import SolidTracker, is_tracked
from standoff.tracking.derivatives import Smoothness
from standoff.tracking.status import Status
from standoff.typing import Array, Ints
from standoff.world.broad_phase import PairTable, PlacedPieces
from standoff.world.model import Model
from standoff.world.moment import FrameTime
from standoff.world.pair_answer import gradient_of_bodies
from standoff.world.pieces import PieceUnion
from standoff.world.placed_solids import PlacedSolid, placed_solid
from standoff.world.shapes import slack_of
from standoff.world.state import PAGE, KeptSolids
from standoff.world.tolerances import ALIKE_PLACED


class SolidRows:
    """The rows of a frame's table that are asked as solids.

    Attributes
    ----------
    rows : (n,) array of bool
    """

    def __init__(
        self,
        world: Model,
        poses: Array,
        frame: PlacedPieces,
        table: PairTable,
        before: KeptSolids,
        moment: FrameTime,
    ) -> None:
        self.world, self.poses, self.frame, self.table = world, poses, frame, table
        self.before, self.moment = before, moment
        ints, self._owners = table.ints, world.search.pieces.owners
        has = world.solids.bodies
        self.rows = has[self._owners[ints[:, W.I_A]]] | has[self._owners[ints[:, W.I_B]]]
        self._found: dict[int, SolidProximity] = {}
        self._fronts: dict[int, KeptFront] = {}
        self._asked: set[int] = set()
        self._cold: dict[tuple[int, int, float | None], list[tuple[Array, SolidProximity]]] = {}

    def settle(self, fates: Ints) -> None:
        """Which rows rest, whatever their status: a cold query would find the same; and which must
        be asked, though another pair of pieces seems nearer."""
        ints, known, still = self.table.ints, self.table.known, self.frame.still
        for k in np.flatnonzero(self.rows).tolist():
            key, p, q = ints[k, [W.I_KEY, W.I_A, W.I_B]].tolist()
            old = self.before.pieces.get(key)
            if old is not None and still[p] and still[q]:
                fates[k] = W.RESTING
                self._found[key] = old
                if key in self.before.fronts:
                    self._fronts[key] = self.before.fronts[key]
                self._note(k, old)
            elif fates[k] != W.FAR or known[k, W.C_BOUND] <= 0.0:
                fates[k] = W.NEW

    def all_asked(self, asking: Ints, fates: Ints) -> bool:
        """Were all rows that are to be asked again found to be far in this frame?"""
        again = np.array([k in self._asked for k in asking.tolist()], dtype=bool)
        fates[asking[again]] = W.FAR
        return bool(again.all())

    def ask(self, asking: Ints, fates: Ints) -> Ints:
        """Ask those of some rows that are asked as solids, each once in a frame; those beyond their
        horizon are far. Returns the other rows."""
        solid = self.rows[asking]
        mine = [k for k in asking[solid].tolist() if k not in self._asked]
        for done, k in enumerate(mine, 1):
            found = self._answer(k)
            if self.moment.progress is not None:
                self.moment.progress(done, len(mine))
            self._asked.add(k)
            self._note(k, found)
            far = found.status is Status.FAR
            fates[k] = W.FAR if far else W.NEW
            if not far:
                self._found[int(self.table.ints[k, W.I_KEY])] = found
        return asking[~solid]

    def _answer(self, k: int) -> SolidProximity:
        """Asked from nothing, or tracked where it was near before; roundoff of placements is in
        its bounds."""
        key, p, q = self.table.ints[k, [W.I_KEY, W.I_A, W.I_B]].tolist()
        (a, pose_a, of_a), (b, pose_b, of_b) = (self._placed(piece) for piece in (p, q))
        doubt = of_a + of_b
        horizon = float(self.table.known[k, W.C_HORIZON])
        # more than the horizon, so that the bound of what is far is beyond it
        more = doubt + slack_of(a) + slack_of(b) + PROOF_TOLERANCE * size_together(a, b)
        within = None if horizon == math.inf else horizon + more
        if key in self.before.pieces and is_tracked(a, b):
            found = self._tracked(key, (a, b), (pose_a, pose_b))
        else:
            found = self._once((p, q), (a, b), (pose_a, pose_b), within)
        return replace(
            found,
            lower_bound=found.lower_bound - doubt,
            upper_bound=found.upper_bound + doubt,
        )

    def _once(
        self,
        pieces: tuple[int, int],
        solids: tuple[Any, Any],
        poses: tuple[Pose, Pose],
        within: float | None,
    ) -> SolidProximity:
        """Asked from nothing, once of all pairs of the same solids that are in one place to each
        other, as those of copies of an assembly are."""
        (a, b), (pose_a, pose_b) = solids, poses
        relative = pose_a.inverse() @ pose_b
        place = pose_row(relative.rotation, relative.translation)
        known = self._cold.setdefault((id(a), id(b), within), [])
        row, pads = self.frame.placed[pieces[1]], self.frame.placed[list(pieces), W.P_PAD].sum()
        low, high = (row[o : o + 3] - pose_b.translation for o in (W.P_LOW, W.P_HIGH))
        reach = float(np.linalg.norm(np.maximum(np.abs(low), np.abs(high))))
        for other, found in known:
            doubt = float(pads) + moved_by(other, place, reach)
            if doubt <= ALIKE_PLACED * size_together(a, b):
                rows = [pose_row(p.rotation, p.translation) for p in (pose_a, pose_b)]
                return found.carried((rows[0], rows[1]), doubt)
        found = distance(a, b, pose_a, pose_b, within=within)
        if found.overlap is None:
            known.append((place, found))
        return found

    def _tracked(
        self, key: int, solids: tuple[Any, Any], poses: tuple[Pose, Pose]
    ) -> SolidProximity:
        """From the bounds of the frame before; the first time from nothing."""
        tracker, old = SolidTracker(*solids), self.before.fronts.get(key)
        if old is None:
            state = tracker.start(*poses)
        else:
            before = SolidState(self.before.pieces[key], (tracker.a, tracker.b), old)
            state, _ = tracker.step(before, *poses)
        if state.front is not None:
            self._fronts[key] = state.front
        return state.proximity

    def _placed(self, p: int) -> PlacedSolid:
        return placed_solid(self.world, self.frame.placed, p)

    def _note(self, k: int, found: SolidProximity) -> None:
        """What an answer says of the signed distance, into the table of pairs."""
        ints, known, placed = self.table.ints, self.table.known, self.frame.placed
        inside = bool(found.inside)
        known[k, W.C_BOUND] = -math.inf if inside else found.lower_bound
        known[k, W.C_UPPER] = 0.0 if inside else found.upper_bound
        known[k, W.C_TRAVEL] = placed[ints[k, [W.I_A, W.I_B]], W.P_TRAVEL].sum()
        ints[k, W.I_STATUS], ints[k, W.I_INSIDE] = found.status.value, 0

    def answers(
        self, fates: Ints, pages: tuple[Array, ...]
    ) -> tuple[KeptSolids, tuple[Array, ...]]:
        """What was found of all pairs of bodies, with a page of their numbers."""
        ints, known = self.table.ints, self.table.known
        fates[self.rows & (known[:, W.C_BOUND] > known[:, W.C_HORIZON])] = W.FAR
        groups = ints[:, W.I_KEY] // self.world.most**2
        near = np.flatnonzero(self.rows & (fates != W.FAR))
        order = near[np.lexsort((known[near, W.C_UPPER], groups[near]))]
        whole: dict[int, SolidProximity] = {}
        blocks: list[Array] = []
        ints[self.rows, W.I_ROW] = -1
        for first in order[np.flatnonzero(np.diff(groups[order], prepend=-1))].tolist():
            group = int(groups[first])
            begin, end = np.searchsorted(groups, [group, group + 1])
            found = self._whole(np.arange(begin, end), fates, int(groups[first]))
            ints[first, W.I_ROW] = (len(pages) << PAGE) + len(blocks)
            ints[first, W.I_STATUS] = found.status.value
            blocks.append(self._block(found, *self._bodies(first)))
            whole[group] = found
        kept = {int(ints[k, W.I_KEY]): self._found[int(ints[k, W.I_KEY])] for k in near.tolist()}
        made = (np.array(blocks),) if blocks else ()
        fronts = {key: self._fronts[key] for key in kept if key in self._fronts}
        return KeptSolids(kept, whole, fronts), (*pages, *made)

    def _bodies(self, k: int) -> tuple[int, int]:
        i, j = self._owners[self.table.ints[k, [W.I_A, W.I_B]]].tolist()
        return i, j

    def _whole(self, rows: Ints, fates: Ints, group: int) -> SolidProximity:
        """The answer of two bodies."""
        known = self.table.known
        i, j = self._bodies(int(rows[0]))
        near = rows[fates[rows] != W.FAR]
        old = self.before.bodies.get(group)
        if old is not None and np.all(fates[near] == W.RESTING):
            return old
        beyond = float(known[rows[fates[rows] == W.FAR], W.C_BOUND].min(initial=math.inf))
        first = self.world.search.pieces.first
        counts = int(first[i + 1] - first[i]), int(first[j + 1] - first[j])
        if len(rows) < counts[0] * counts[1]:  # the others are beyond the search's reach
            beyond = min(beyond, self.world.search.reach)
        parts = [self._part(k) for k in near.tolist()]
        found = answer_of_pieces(parts, counts, beyond, self._ball)
        chosen = next(part for part in parts if part.names == found.pieces)
        arms = np.array([self._arm(p) for p in (chosen.a + first[i], chosen.b + first[j])])
        poses = [pose_row(self.poses[k, :3, :3], self.poses[k, :3, 3]) for k in (i, j)]
        rows_of_bodies = gradient_of_bodies(found.gradient_rows, arms)
        return replace(found, gradient_rows=rows_of_bodies, poses=(poses[0], poses[1]))

    def _part(self, k: int) -> OfPieces:
        key, p, q = self.table.ints[k, [W.I_KEY, W.I_A, W.I_B]].tolist()
        solids = self._placed(p).solid, self._placed(q).solid
        (a, one), (b, other) = self._piece(p), self._piece(q)
        return OfPieces(a, b, (one, other), self._found[key], solids)

    def _piece(self, p: int) -> tuple[int, str]:
        """Its number in its body, and its name."""
        i = int(self._owners[p])
        number = p - int(self.world.search.pieces.first[i])
        body = self.world.listed[i][1]
        return number, list(body.pieces)[number] if isinstance(body, PieceUnion) else ""

    def _arm(self, p: int) -> Array:
        """From the body's origin to the piece's, world axes."""
        shift = self.frame.placed[p, W.P_SHIFT : W.P_SHIFT + 3]
        return np.asarray(shift - self.poses[self._owners[p], :3, 3])

    def _ball(self, part: OfPieces) -> Overlap:
        """Inside the piece that is inside the other."""
        found = part.found
        point, pose = (
            (found.point_a, found.poses[0])
            if found.inside == "A"
            else (found.point_b, found.poses[1])
        )
        inner = part.solids["AB".index(found.inside)]
        return ball_inside(inner, Pose(pose[:9].reshape(3, 3), pose[9:]), point, found.normal)

    def _block(self, found: SolidProximity, i: int, j: int) -> Array:
        """What the arrays of all pairs read of an answer."""
        block = np.full(K.N_BLOCK, np.nan)
        block[K.DISTANCE], block[K.LOWER_BOUND] = found.distance, found.lower_bound
        block[K.UPPER_BOUND], block[K.STATUS] = found.upper_bound, found.status.value
        for at, vector in (
            (K.POINT_A, found.point_a),
            (K.POINT_B, found.point_b),
            (K.NORMAL, found.normal),
        ):
            block[at : at + 3] = vector
        block[K.BLOCK_POLYTOPE] = 0.0
        if self.moment.has_twist and found.smoothness is Smoothness.SMOOTH:
            twist = self.moment.twists[[i, j], :6].ravel()
            block[K.OUT_RATE] = found.gradient_rows @ twist
        return block
