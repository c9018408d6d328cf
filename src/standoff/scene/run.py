"""Running a scene: one cold query, or the tracker over all frames."""

from __future__ import annotations

import hashlib
import math
from dataclasses import replace
from typing import Any

import numpy as np

from standoff.errors import StandoffError
from standoff.impact import Impact, time_of_impact
from standoff.progress import Progress
from standoff.recording import Recording
from standoff.recording.track import track_along
from standoff.scene.errors import SceneError
from standoff.scene.scene import Scene
from standoff.scene.settings import TrackSettings
from standoff.solids.answer import SolidProximity
from standoff.solids.spatial.models import as_model
from standoff.tracking import Proximity, Tracker, distance
from standoff.tracking.law_options import options_of
from standoff.tracking.laws import PredictorCorrector
from standoff.typing import Array
from standoff.world.shapes import is_solid


def query(scene: Scene, time: float | None = None) -> tuple[float, Proximity | SolidProximity]:
    """Return the pair's certified distance at one instant, without a tracker.

    Raises SceneError if the instant is outside the scene's times, or the pair cannot be asked for a
    distance.

    Parameters
    ----------
    scene : Scene
    time : float, optional
        Scene time [s], from the scene's start to its end; the first frame's if not given.

    Returns
    -------
    (float, Proximity or SolidProximity)
        The instant and the answer.
    """
    instant = scene.instant(time)
    a, b = scene.pair_shapes
    try:
        pose_a, pose_b = (motion.path.pose(instant) for motion in scene.pair_motions)
        found: Proximity | SolidProximity = distance(a, b, pose_a, pose_b)
        return instant, found
    except (ValueError, TypeError) as error:
        raise SceneError(str(error), key="pair", file=scene.file) from error


def first_impact(
    scene: Scene, settings: TrackSettings | None = None, clearance: float = 0.0
) -> Impact:
    """Return the first time at which the pair comes to a clearance, within the scene's times.

    A search needs no frames: it begins at the start and ends after the duration.

    Raises SceneError if the times are not possible, or the pair cannot be asked for a distance.

    Parameters
    ----------
    scene : Scene
    settings : TrackSettings, optional
        Overrides the scene's own.
    clearance : float
        Distance that counts as impact [length].

    Returns
    -------
    Impact
    """
    start, end = scene.window(settings)
    duration = end - start
    a, b = scene.pair_shapes
    path_a, path_b = (motion.path for motion in scene.pair_motions)
    try:
        return time_of_impact(a, b, path_a, path_b, duration, clearance=clearance, start=start)
    except (ValueError, TypeError) as error:
        raise SceneError(str(error), key="pair", file=scene.file) from error


def prepare(scene: Scene, settings: TrackSettings) -> tuple[Tracker, Array]:
    """Return the tracker and the frame times of a run, all checked.

    Raises SceneError if the times are not possible or the tracker refuses its settings.
    """
    times = scene.times(settings)
    a, b = scene.pair_shapes
    try:
        # The longest step: the default gain, and the check of a given one, hold for all.
        tracker = made_tracker(a, b, float(np.diff(times).max()), settings)
    except (ValueError, TypeError) as error:
        raise SceneError(str(error), key="track", file=scene.file) from error
    return tracker, times


def record(
    scene: Scene, settings: TrackSettings | None = None, progress: Progress | None = None
) -> Recording:
    """Track the scene's pair over all frames.

    Raises SceneError as `prepare`, or if the pair cannot be tracked, as a planar body out of its
    plane.

    Parameters
    ----------
    scene : Scene
    settings : TrackSettings, optional
        Overrides the scene's own.
    progress : callable, optional
        Called now and then with the frames done and the frames in all.

    Returns
    -------
    Recording
    """
    settings = settings or scene.settings
    tracker, times = prepare(scene, settings)
    path_a, path_b = (motion.path for motion in scene.pair_motions)
    try:
        recording = track_along(tracker, path_a, path_b, times, progress=progress)
    except (ValueError, TypeError) as error:
        raise SceneError(str(error), key="pair", file=scene.file) from error
    info = replace(
        recording.info,
        bodies=scene.pair,
        title=scene.title,
        length_unit=scene.length_unit,
        source=_source(scene, settings),
    )
    return replace(recording, info=info)


def _source(scene: Scene, settings: TrackSettings) -> dict[str, Any]:
    """Return what shows a recording's reader how it was made, without this machine's paths."""
    files = [motion.file for motion in scene.pair_motions if motion.file is not None]
    return {
        "scene": scene.file.name,
        "pair": scene.selected.name,
        "scene_text": scene.text,
        "settings": settings.facts(),
        "notes": scene.notes,
        "samples_sha256": {
            file.name: hashlib.sha256(file.read_bytes()).hexdigest() for file in files
        },
    }


# What the settings of a scene mean for a pair with a solid that need not be convex.

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
