"""Exact, certified minimum distance of curved convex bodies in motion.

The public face: one import path a symbol. ``import standoff as so``.
"""

from standoff.bodies import Apex, Body, BodyError, Edge, Face, shapes
from standoff.motion import Pose, Twist
from standoff.tracking import (
    Counts,
    Event,
    Feature,
    FrameBuffer,
    Proximity,
    RecordedEvent,
    Recording,
    RunInfo,
    Status,
    Tracker,
    TrackerState,
    Visit,
    distance,
    max_gain,
    open_recording,
    simulate,
)

__version__ = "0.1.0"

__all__ = [
    "Apex",
    "Body",
    "BodyError",
    "Counts",
    "Edge",
    "Event",
    "Face",
    "Feature",
    "FrameBuffer",
    "Pose",
    "Proximity",
    "RecordedEvent",
    "Recording",
    "RunInfo",
    "Status",
    "Tracker",
    "TrackerState",
    "Twist",
    "Visit",
    "distance",
    "max_gain",
    "open_recording",
    "shapes",
    "simulate",
]
