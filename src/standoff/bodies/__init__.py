"""Boundaries of solids, and bodies, whose boundary is convex: checked and packed once."""

from typing import TYPE_CHECKING

from standoff.on_demand import on_demand

if TYPE_CHECKING:
    from standoff.bodies.body import Body
    from standoff.bodies.boundary import Boundary, EdgeKind
    from standoff.bodies.meshes.columns import Fit
    from standoff.bodies.meshes.decomposition import Decomposition, decomposition
    from standoff.bodies.report import BodyReport, BoundaryReport, DihedralAngle, PatchCheck
    from standoff.bodies.topology import Apex, Edge, Face
    from standoff.errors import BodyError
else:
    __getattr__, __dir__ = on_demand(__name__)

__all__ = [
    "Apex",
    "Body",
    "BodyError",
    "BodyReport",
    "Boundary",
    "BoundaryReport",
    "Decomposition",
    "DihedralAngle",
    "Edge",
    "EdgeKind",
    "Face",
    "Fit",
    "PatchCheck",
    "decomposition",
]
