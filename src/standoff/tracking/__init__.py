"""Tracking: the tracker and its answers."""

from typing import TYPE_CHECKING

from standoff.on_demand import on_demand

if TYPE_CHECKING:
    from standoff.bodies.features import Feature
    from standoff.tracking import feedback
    from standoff.tracking.automaton import Automaton, Transition
    from standoff.tracking.feedback import max_gain
    from standoff.tracking.impact import Impact, ImpactStatus, time_of_impact
    from standoff.tracking.pair_system import PairSystem, pair_system
    from standoff.tracking.point_answer import Minimum, PointCounts, PointEvent, PointProximity
    from standoff.tracking.point_recording import PointRecording, PointVisit, record_point
    from standoff.tracking.point_state import PointState
    from standoff.tracking.point_tracker import PointTracker
    from standoff.tracking.proximity import Counts, Event, Proximity
    from standoff.tracking.recording import (
        RecordedEvent,
        Recording,
        RunInfo,
        open_recording,
    )
    from standoff.tracking.simulate import simulate
    from standoff.tracking.spatial_point_answer import (
        DepthMinimum,
        SpatialPointProximity,
        SpatialPointState,
    )
    from standoff.tracking.spatial_point_tracker import SpatialPointTracker
    from standoff.tracking.state import FrameBuffer, TrackerState
    from standoff.tracking.status import Status
    from standoff.tracking.tracker import Tracker, distance
    from standoff.tracking.visits import Visit
    from standoff.tracking.witness_set import WitnessSet, witness_set
else:
    __getattr__, __dir__ = on_demand(
        __name__,
        {
            "standoff.bodies.features": ("Feature",),
            "standoff.tracking.automaton": ("Automaton", "Transition"),
            "standoff.tracking.feedback": ("max_gain",),
            "standoff.tracking.impact": ("Impact", "ImpactStatus", "time_of_impact"),
            "standoff.tracking.pair_system": ("PairSystem", "pair_system"),
            "standoff.tracking.point_answer": (
                "Minimum",
                "PointCounts",
                "PointEvent",
                "PointProximity",
            ),
            "standoff.tracking.point_recording": ("PointRecording", "PointVisit", "record_point"),
            "standoff.tracking.point_state": ("PointState",),
            "standoff.tracking.point_tracker": ("PointTracker",),
            "standoff.tracking.proximity": ("Counts", "Event", "Proximity"),
            "standoff.tracking.recording": (
                "RecordedEvent",
                "Recording",
                "RunInfo",
                "open_recording",
            ),
            "standoff.tracking.simulate": ("simulate",),
            "standoff.tracking.spatial_point_answer": (
                "DepthMinimum",
                "SpatialPointProximity",
                "SpatialPointState",
            ),
            "standoff.tracking.spatial_point_tracker": ("SpatialPointTracker",),
            "standoff.tracking.state": ("FrameBuffer", "TrackerState"),
            "standoff.tracking.status": ("Status",),
            "standoff.tracking.tracker": ("Tracker", "distance"),
            "standoff.tracking.visits": ("Visit",),
            "standoff.tracking.witness_set": ("WitnessSet", "witness_set"),
        },
    )

__all__ = [
    "Automaton",
    "Counts",
    "DepthMinimum",
    "Event",
    "Feature",
    "FrameBuffer",
    "Impact",
    "ImpactStatus",
    "Minimum",
    "PairSystem",
    "PointCounts",
    "PointEvent",
    "PointProximity",
    "PointRecording",
    "PointState",
    "PointTracker",
    "PointVisit",
    "Proximity",
    "RecordedEvent",
    "Recording",
    "RunInfo",
    "SpatialPointProximity",
    "SpatialPointState",
    "SpatialPointTracker",
    "Status",
    "Tracker",
    "TrackerState",
    "Transition",
    "Visit",
    "WitnessSet",
    "distance",
    "feedback",
    "max_gain",
    "open_recording",
    "pair_system",
    "record_point",
    "simulate",
    "time_of_impact",
    "witness_set",
]
