"""The tracker, its laws and its answers."""

from typing import TYPE_CHECKING

from standoff.on_demand import on_demand

if TYPE_CHECKING:
    from standoff.bodies.features import Feature
    from standoff.tracking import feedback
    from standoff.tracking.answers import Answers
    from standoff.tracking.branches import (
        Birth,
        Branch,
        BranchCounts,
        Branches,
        Change,
        End,
    )
    from standoff.tracking.cold_query import distance
    from standoff.tracking.contact.patches import Patch, Patches
    from standoff.tracking.contact.witness_set import WitnessSet, witness_set
    from standoff.tracking.derivatives import DerivativeArrays, Derivatives, Smoothness
    from standoff.tracking.distance_arrays import Distances
    from standoff.tracking.feedback import max_gain
    from standoff.tracking.frame_buffer import FrameBuffer
    from standoff.tracking.laws import PaperLaw, PredictorCorrector
    from standoff.tracking.many_distances import distances
    from standoff.tracking.many_states import TrackerStates
    from standoff.tracking.pair_plot import plot
    from standoff.tracking.pair_system import PairSystem, pair_system
    from standoff.tracking.proximity import Counts, Event, Proximity
    from standoff.tracking.state import TrackerState
    from standoff.tracking.status import Status
    from standoff.tracking.tracker import Tracker
else:
    __getattr__, __dir__ = on_demand(__name__, modules=("feedback",))

__all__ = [
    "Answers",
    "Birth",
    "Branch",
    "BranchCounts",
    "Branches",
    "Change",
    "Counts",
    "DerivativeArrays",
    "Derivatives",
    "Distances",
    "End",
    "Event",
    "Feature",
    "FrameBuffer",
    "PairSystem",
    "PaperLaw",
    "Patch",
    "Patches",
    "PredictorCorrector",
    "Proximity",
    "Smoothness",
    "Status",
    "Tracker",
    "TrackerState",
    "TrackerStates",
    "WitnessSet",
    "distance",
    "distances",
    "feedback",
    "max_gain",
    "pair_system",
    "plot",
    "witness_set",
]
