"""What a tracker of solids asks in each frame, and an answer from nothing by it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.kernels.entries import solid_blocks as B
from standoff.motion import Pose
from standoff.solids.answer import SolidProximity
from standoff.solids.asked import DEADLINE, QueryOptions
from standoff.solids.spatial.distance import (
    reach_of_minima,
    senses_of,
    spatial_distance,
    told_apart,
)
from standoff.solids.spatial.minimum import SearchOptions
from standoff.solids.spatial.overlapping import contact_reach, told_in_contact
from standoff.solids.spatial.pair import PlacedPair
from standoff.solids.spatial.patches import rows_of
from standoff.solids.spatial.solid_model import SolidModel
from standoff.solids.spatial.stationary import fans_of
from standoff.solids.spatial.told import Inside
from standoff.solids.spatial.tolerances import CONTACT_REACH, PROOF_ROUNDING, PROOF_TOLERANCE
from standoff.solids.tracked.contact import (
    ContactFrames,
    ContactPlaces,
    ContactWork,
    begun,
    unknown,
)
from standoff.solids.tracked.front import (
    NO_MINIMA,
    FrontArrays,
    FrontFrames,
    KeptFront,
    Minima,
    front_at,
    front_in_contact,
    room_for,
)
from standoff.tracking.status import Status
from standoff.typing import Array


class TrackedPair(NamedTuple):
    """Two solids, and the options of their tracker."""

    a: SolidModel
    b: SolidModel
    options: QueryOptions

    @property
    def proof(self) -> float:
        """To what the distance is proven where roundings are smaller, length."""
        tolerance = self.options.tolerance
        return PROOF_TOLERANCE * (self.a.size + self.b.size) if tolerance is None else tolerance

    def in_time(self) -> TrackedPair:
        """The same with the time that a query has by default, at least."""
        most = max(self.options.deadline, DEADLINE)
        return self._replace(options=self.options._replace(deadline=most))

    def sought(self, pair: PlacedPair) -> SearchOptions:
        """What a search at poses is asked."""
        reach = reach_of_minima(self.options.minima, self.options.patch)
        return SearchOptions(pair.provable(self.proof), self.options.deadline, np.inf, *reach)

    @property
    def minima(self) -> Minima:
        """What frames are asked of local minima."""
        minima, patch = self.options.minima, self.options.patch
        if minima is None:
            return NO_MINIMA
        above = reach_of_minima(minima, patch)[0]
        return Minima(above, patch or 0.0, (fans_of(self.a), fans_of(self.b)))

    @property
    def numbers(self) -> Array:
        """What compiled frames are asked, as ``kernels.entries.solid_blocks`` lays it out."""
        a, b, minima, found = self.a, self.b, self.minima, np.empty(B.N_ASKED)
        found[B.Q_FRAME : B.Q_DEADLINE] = self.proof, PROOF_ROUNDING, minima.above, minima.wider
        found[B.Q_DEADLINE] = self.options.deadline
        found[B.Q_IN_TIME] = self.in_time().options.deadline
        found[B.Q_SIZE_A], found[B.Q_SIZE_B], found[B.Q_SLACK] = a.size, b.size, a.slack + b.slack
        found[B.Q_DEEP], found[B.Q_PROOF] = CONTACT_REACH, PROOF_TOLERANCE
        found[B.Q_POINTS] = DEADLINE
        return found

    def frames(self, front: KeptFront, room: FrontArrays | None = None) -> FrontFrames:
        """Frames from a front on; `room`: arrays that nobody else writes to meanwhile."""
        packed = self.a.packed, self.b.packed
        return FrontFrames(packed, front, self.proof, self.options.deadline, self.minima, room)

    def cold(self, pair: PlacedPair, born: int = 0) -> tuple[SolidProximity, KeptFront | None]:
        """An answer from nothing, with the front that frames go on from where there is one. `born`:
        how many branches there were before."""
        pose_a, pose_b = (Pose.from_checked(row[:9].reshape(3, 3), row[9:]) for row in pair.poses)
        # of local minima a frame proves less, and is far from so dear where walls are side by side
        nearest = self._replace(options=self.options._replace(minima=None, patch=None))
        answer = spatial_distance(self.a, self.b, pose_a, pose_b, nearest.options)
        answer = replace(answer, counts=answer.counts._replace(restarts=1))
        undecided = answer.status is Status.DEADLINE and answer.distance > 0.0
        if answer.lower_bound <= 0.0 and not undecided:
            return answer, None
        senses = senses_of(answer.inside)
        found = pair.least(senses, nearest.sought(pair))
        front = front_at(pair, found, senses, self.sought(pair), born)
        if answer.lower_bound <= 0.0:
            # another query would come no farther: frames go on with what each of them proves
            return answer, front
        frames = self.frames(front)
        frames.go(pair.relative[None], room_for(1))
        if self.options.minima is not None:
            told = self.apart(pair, frames, answer.inside, 0.0)
            counts = told.counts._replace(
                evaluations=answer.counts.evaluations + told.counts.evaluations, restarts=1
            )
            answer = replace(told, counts=counts)
        return answer, frames.kept()

    def met(
        self,
        placed: tuple[PlacedPair, Array],
        front: KeptFront | None,
        born: int,
        before: Array | None,
    ) -> tuple[SolidProximity, KeptFront, NDArray[np.int64]] | None:
        """The answer of a frame in which the solids overlap, the front after it, and which branches
        have come to the place of another one; None where that is not proven. `placed`: both, and
        B's pose (12,) in A's frame; `before`: that in the frame before, if they did not overlap in
        it."""
        pair, pose = placed
        front = front or front_in_contact(pair, self.sought(pair), born)
        if front.contact is None:
            contact = unknown(born) if before is None else begun(before, front)
            front = front._replace(contact=contact)
        frames = self.contact(front)
        if not frames.go(pose):
            return None
        return self.in_contact(pair, frames.places()), frames.kept(), frames.merged()

    def contact(self, front: KeptFront, room: ContactWork | None = None) -> ContactFrames:
        """Frames from a front with a contact on; `room`: as of `frames`."""
        return ContactFrames((self.a, self.b), front, self.numbers, room)

    def in_contact(self, pair: PlacedPair, places: ContactPlaces) -> SolidProximity:
        """The answer of a frame of a contact."""
        reach = contact_reach(pair, self.sought(pair))
        return told_in_contact(pair, *places, reach, self.options.minima)

    def apart(
        self, pair: PlacedPair, frames: FrontFrames, inside: Inside, motion: float
    ) -> SolidProximity:
        """The answer of the last frame by what was found in it, after a motion of B, length."""
        sought = self.sought(pair)
        answer, places = told_apart(pair, frames.found(), senses_of(inside), inside, sought)
        if self.options.minima is None:
            return answer
        return numbered(answer, frames.number(*rows_of(pair, places), motion))


def numbered(answer: SolidProximity, numbers: NDArray[Any]) -> SolidProximity:
    """With the keys of its minima."""
    named = zip(answer.minima, numbers, strict=True)
    return replace(answer, minima=tuple(m._replace(key=int(k)) for m, k in named))
