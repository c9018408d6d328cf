"""Tracking: the tracker and its answers."""

from standoff.tracking.automaton import Automaton, Transition
from standoff.tracking.options import max_gain
from standoff.tracking.proximity import Counts, Event, Feature, Proximity
from standoff.tracking.recording import (
    RecordedEvent,
    Recording,
    RunInfo,
    Visit,
    open_recording,
)
from standoff.tracking.simulate import simulate
from standoff.tracking.state import FrameBuffer, TrackerState
from standoff.tracking.status import Status
from standoff.tracking.tracker import Tracker, distance

__all__ = [
    "Automaton",
    "Counts",
    "Event",
    "Feature",
    "FrameBuffer",
    "Proximity",
    "RecordedEvent",
    "Recording",
    "RunInfo",
    "Status",
    "Tracker",
    "TrackerState",
    "Transition",
    "Visit",
    "distance",
    "max_gain",
    "open_recording",
    "simulate",
]
