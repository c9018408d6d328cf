"""Exact, certified distances of curved bodies, convex or not, still or in motion.

The names of every day; the rest is in modules that load when asked for: `so.points`, `so.voronoi`,
`so.impact`, `so.recording`, `so.automaton`, `so.bodies`, `so.geometry`, `so.motion`, `so.tracking`,
`so.control`, `so.simulation`, `so.devices`, `so.servo`, `so.scene`, `so.world`, `so.robots`,
`so.solids`, `so.cad`, `so.clearance`.
"""

from typing import TYPE_CHECKING

from standoff.on_demand import on_demand
from standoff.version import __version__ as __version__

if TYPE_CHECKING:
    from standoff.bodies import Body, shapes
    from standoff.bodies.voronoi import voronoi_regions
    from standoff.cad import read_step
    from standoff.control import min_gain
    from standoff.design import Design, shape_gradient
    from standoff.errors import BodyError, StandoffError
    from standoff.impact import time_of_impact
    from standoff.motion import Pose, Poses, Twist
    from standoff.points import PointTracker
    from standoff.recording import Recording, open_recording, track
    from standoff.robots import Robot
    from standoff.solids import PlanarSolid, Solid
    from standoff.tracking import (
        Event,
        Feature,
        PaperLaw,
        PredictorCorrector,
        Proximity,
        Status,
        Tracker,
        TrackerState,
        WitnessSet,
        distance,
        distances,
        feedback,
        max_gain,
        plot,
        witness_set,
    )
    from standoff.view import view
    from standoff.world import World, compound
else:
    __getattr__, __dir__ = on_demand(
        __name__,
        modules=(
            "automaton",
            "bodies",
            "cad",
            "clearance",
            "control",
            "devices",
            "geometry",
            "impact",
            "motion",
            "points",
            "recording",
            "robots",
            "scene",
            "servo",
            "simulation",
            "solids",
            "tracking",
            "voronoi",
            "world",
        ),
    )

__all__ = [
    "Body",
    "BodyError",
    "Design",
    "Event",
    "Feature",
    "PaperLaw",
    "PlanarSolid",
    "PointTracker",
    "Pose",
    "Poses",
    "PredictorCorrector",
    "Proximity",
    "Recording",
    "Robot",
    "Solid",
    "StandoffError",
    "Status",
    "Tracker",
    "TrackerState",
    "Twist",
    "WitnessSet",
    "World",
    "compound",
    "distance",
    "distances",
    "feedback",
    "max_gain",
    "min_gain",
    "open_recording",
    "plot",
    "read_step",
    "shape_gradient",
    "shapes",
    "time_of_impact",
    "track",
    "view",
    "voronoi_regions",
    "witness_set",
]
