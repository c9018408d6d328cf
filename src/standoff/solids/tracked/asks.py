"""What a tracker of solids asks in each frame, and an answer from nothing by it."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from standoff.motion import Pose
from standoff.solids.answer import SolidProximity
from standoff.solids.asked import DEADLINE, Asked
from standoff.solids.spatial.distance import reach_of_minima, senses_of, spatial_distance
from standoff.solids.spatial.minimum import Sought
from standoff.solids.spatial.pair import PlacedPair
from standoff.solids.spatial.solid_model import SolidModel
from standoff.solids.spatial.tolerances import PROOF_TOLERANCE
from standoff.solids.tracked.front import Frames, Front, front_at, room_for


class Asks(NamedTuple):
    """Two solids, and the options of their tracker."""

    a: SolidModel
    b: SolidModel
    options: Asked

    @property
    def proof(self) -> float:
        """To what the distance is proven where roundings are smaller, length."""
        tolerance = self.options.tolerance
        return PROOF_TOLERANCE * (self.a.size + self.b.size) if tolerance is None else tolerance

    def in_time(self) -> Asks:
        """The same with the time that a query has by default, at least."""
        most = max(self.options.deadline, DEADLINE)
        return self._replace(options=self.options._replace(deadline=most))

    def sought(self, pair: PlacedPair) -> Sought:
        """What a search at poses is asked."""
        reach = reach_of_minima(self.options.minima, self.options.patch)
        return Sought(pair.provable(self.proof), self.options.deadline, np.inf, *reach)

    def frames(self, front: Front) -> Frames:
        """Frames from a front on."""
        above = reach_of_minima(self.options.minima, self.options.patch)[0]
        packed = self.a.packed, self.b.packed
        return Frames(packed, front, self.proof, self.options.deadline, above)

    def cold(self, pair: PlacedPair) -> tuple[SolidProximity, Front | None]:
        """An answer from nothing, with the front that frames go on from where there is one."""
        pose_a, pose_b = (Pose.from_checked(row[:9].reshape(3, 3), row[9:]) for row in pair.poses)
        answer = spatial_distance(self.a, self.b, pose_a, pose_b, self.options)
        answer = replace(answer, counts=answer.counts._replace(restarts=1))
        if answer.lower_bound <= 0.0:
            return answer, None
        sought, senses = self.sought(pair), senses_of(answer.inside)
        frames = self.frames(front_at(pair, pair.least(senses, sought), senses, sought))
        frames.go(pair.relative[None], room_for(1))
        return answer, frames.kept()
