"""Bodies: closed sets of convex patches, checked and packed once; ready-made shapes."""

from standoff.bodies.body import Body
from standoff.bodies.report import BodyReport, DihedralAngle, PatchCheck
from standoff.bodies.topology import Apex, BodyError, Edge, Face

__all__ = ["Apex", "Body", "BodyError", "BodyReport", "DihedralAngle", "Edge", "Face", "PatchCheck"]
