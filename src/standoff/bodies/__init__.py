"""Bodies: closed sets of convex patches, checked and packed once; ready-made shapes."""

from typing import TYPE_CHECKING

from standoff.on_demand import on_demand

if TYPE_CHECKING:
    from standoff.bodies.body import Body
    from standoff.bodies.report import BodyReport, DihedralAngle, PatchCheck
    from standoff.bodies.topology import Apex, Edge, Face
    from standoff.errors import BodyError
else:
    __getattr__, __dir__ = on_demand(
        __name__,
        {
            "standoff.bodies.body": ("Body",),
            "standoff.bodies.report": ("BodyReport", "DihedralAngle", "PatchCheck"),
            "standoff.bodies.topology": ("Apex", "Edge", "Face"),
            "standoff.errors": ("BodyError",),
        },
    )

__all__ = ["Apex", "Body", "BodyError", "BodyReport", "DihedralAngle", "Edge", "Face", "PatchCheck"]
