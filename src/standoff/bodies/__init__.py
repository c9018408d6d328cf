"""Bodies: closed sets of convex patches, checked and packed once; ready-made shapes."""

from standoff.bodies.body import Body, BodyReport
from standoff.bodies.topology import Apex, BodyError, Edge, Face

__all__ = ["Apex", "Body", "BodyError", "BodyReport", "Edge", "Face"]
