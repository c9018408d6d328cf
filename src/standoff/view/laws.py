"""The law that a page chooses: its name, integrator and gain, within what is stable."""

from __future__ import annotations

from typing import Any

import numpy as np

from standoff.motion import Fixed
from standoff.scene import Scene, SceneError
from standoff.scene.settings import DEFAULT_STEP, TrackSettings
from standoff.tracking import PaperLaw, max_gain
from standoff.tracking.laws import LAWS

NAMES = tuple(LAWS)
INTEGRATORS = ("euler", "heun", "midpoint", "rk4")


def frame_time(scene: Scene) -> float:
    """Return the time from frame to frame [s], of uneven frames the longest."""
    step = scene.settings.step
    if isinstance(step, float):
        return step
    if all(isinstance(motion.path, Fixed) for motion in scene.pair_motions):
        return DEFAULT_STEP
    return float(np.diff(scene.times()).max())


def moves(scene: Scene) -> bool:
    """Does any of the two bodies move?"""
    return not all(isinstance(motion.path, Fixed) for motion in scene.pair_motions)


def with_law(settings: TrackSettings, law: str, integrator: str, share: float, dt: float) -> Any:
    """Return settings with another law.

    Raises SceneError if they do not go together.

    Parameters
    ----------
    settings : TrackSettings
    law, integrator : str
    share : float
        Gain of the paper's law over the largest that is stable, above 0 and below 1.
    dt : float
        Frame time [s].
    """
    if law not in LAWS or integrator not in INTEGRATORS or not 0.0 < share < 1.0:
        raise SceneError(f"no law: {law!r}, {integrator!r}, {share!r}")
    if law != PaperLaw.name:
        return settings.overridden({"law": law})
    gain = share * max_gain(integrator, dt)
    return settings.overridden({"law": law, "integrator": integrator, "gain": gain})


def chosen(settings: TrackSettings, dt: float) -> tuple[str, str, float]:
    """Return name, integrator and share of the greatest gain of the law that settings have."""
    law = settings.law
    if not isinstance(law, PaperLaw) or law.feedback is not None:
        return law.name, "heun", 0.5
    share = (law.gain or 1.0 / dt) / max_gain(law.integrator, dt)
    return law.name, law.integrator, min(max(share, 0.01), 0.99)
