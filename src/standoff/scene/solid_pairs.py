"""What the settings of a scene mean for a pair with a solid that need not be convex."""

from __future__ import annotations

import math
from typing import Any

from standoff.errors import StandoffError
from standoff.scene.settings import TrackSettings
from standoff.solids.spatial.models import as_model
from standoff.tracking import Tracker
from standoff.tracking.law_options import options_of
from standoff.tracking.laws import PredictorCorrector
from standoff.world.shapes import is_solid

OF_SOLIDS = ("tolerance", "deadline")
"""Options of laws that a tracker of solids has too."""


def made_tracker(a: Any, b: Any, dt: float, settings: TrackSettings) -> Tracker:
    """The tracker of a pair.

    Raises StandoffError: settings that are not for such a pair, or what the tracker refuses.

    Parameters
    ----------
    a, b : Body, Solid or PlanarSolid
    dt : float
        The longest step, s.
    settings : TrackSettings
    """
    if not (is_solid(a) or is_solid(b)):
        if settings.minima is not None:
            raise StandoffError(
                f"minima = {settings.minima:g} is of pairs with a solid that need not be convex: "
                "two convex bodies have one minimum; leave it out, or give it in the table of a "
                "pair with a solid.",
                "minima",
                settings.minima,
            )
        return Tracker(a, b, dt, settings.law)
    made: Tracker = _solid_tracker(a, b, dt, settings)
    return made


def _solid_tracker(a: Any, b: Any, dt: float, settings: TrackSettings) -> Any:
    for shape in (a, b):
        if shape.dimension != 3:
            raise StandoffError(
                f"{shape.name} is planar, and of solids that need not be convex only those in "
                "space are tracked: ask `standoff distance`, or so.solids.distance in each frame.",
                "pair",
            )
    law = settings.law
    if not isinstance(law, PredictorCorrector):
        raise StandoffError(
            f"law = '{law.name}': one body of the pair is a solid that need not be convex, and "
            "such a pair follows no law; leave it out.",
            "law",
            law.name,
        )
    for name, option in options_of(law).items():
        value = getattr(law, name)
        if name not in OF_SOLIDS and value != option.default:
            raise StandoffError(
                f"{name} = {value!r} is of convex bodies, and one body of the pair is a solid that "
                f"need not be; leave it out: solids have {', '.join((*OF_SOLIDS, 'minima'))}.",
                name,
                value,
            )
    if math.isinf(law.tolerance):
        raise StandoffError(
            "tolerance = inf: solids are proven to a tolerance; give a finite one.", "tolerance"
        )
    options: dict[str, Any] = {"minima": settings.minima}
    if law.tolerance != options_of(law)["tolerance"].default:
        options["tolerance"] = law.tolerance * (as_model(a).size + as_model(b).size)
    if law.deadline is not None:
        options["deadline"] = law.deadline
    return Tracker(a, b, dt, **options)
