"""`so.view`: the live page from Python and notebooks."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from standoff.bodies.body import Body
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.motion import Fixed, Pose
from standoff.recording import Recording
from standoff.scene import Scene, load_scene
from standoff.scene.motions import Motion
from standoff.scene.pairs import Pair
from standoff.scene.settings import TrackSettings

if TYPE_CHECKING:
    from standoff.view.page import Page

GIVE = (
    "give the file of a scene, a Scene, a Recording that so.track returned, or two bodies with "
    "their poses"
)


def view(*what: Any, host: str = "127.0.0.1", port: int | None = None, open: bool = True) -> Page:
    """Show a scene, a run or a pair of bodies in the browser (docs/live-page.md).

    Parameters
    ----------
    *what
        The file of a scene, a Scene, or a Recording that ``so.track`` returned; or two bodies
        and where they are, ``so.view(a, b, pose_a, pose_b)``.
    host : str
        Name or address to serve the page at; only this machine, if not given.
    port : int, optional
        Any that is free, if not given.
    open : bool
        Open the page in the usual browser.

    Returns
    -------
    Page
        It serves until ``close``, or until the end of its ``with`` block; open its ``address``. In
        a notebook it shows itself.

    Raises
    ------
    ModuleNotFoundError
        If viser is not installed; the message names the extra.
    TypeError
        If that cannot be shown.
    ValueError
        If a scene is refused, the pair cannot be tracked, or the port is not available.
    """
    scene = _scene(what)
    from standoff.view.page import Page

    page = Page(scene, host=host, port=port)
    if open:
        import webbrowser

        webbrowser.open(page.address)
    return page


def _scene(what: tuple[Any, ...]) -> Scene:
    match what:
        case (Scene() as scene,):
            return scene
        case (str() | os.PathLike() as file,):
            return load_scene(file)
        case (Recording() as recording,):
            return scene_of(recording)
        case (Body() as a, Body() as b, pose_a, pose_b):
            paths = Fixed(Pose.of(pose_a)), Fixed(Pose.of(pose_b))
            return _made((a, b), paths, "Two bodies", "", TrackSettings())
    raise StandoffTypeError(f"{shown(what)} cannot be shown: {GIVE}.", "what", what)


@dataclass(frozen=True)
class _Stretch:
    """A path between two times."""

    path: Any
    start: float
    end: float

    def pose(self, t: float) -> Pose:
        return Pose.of(self.path.pose(t))

    def twist(self, t: float) -> Any:
        return self.path.twist(t)


def scene_of(recording: Recording) -> Scene:
    """Return the scene of which a recording was made.

    Parameters
    ----------
    recording : Recording

    Raises
    ------
    StandoffError
        If it was opened from a file or copied: it does not hold what moved then.
    """
    if recording.pair is None or recording.paths is None:
        raise StandoffError(
            "A recording that was opened from a file, copied or unpickled does not hold what "
            "moved: show the one that so.track returned.",
            "what",
            recording,
        )
    first, last = (float(recording.time[k]) for k in (0, -1))
    ends = [
        path if isinstance(path, Fixed) else _Stretch(path, first, last) for path in recording.paths
    ]
    step = float(np.diff(recording.time).max())
    settings = TrackSettings(recording.info.law, step, first, last - first)
    info = recording.info
    return _made(
        recording.pair, (ends[0], ends[1]), info.title or "A run", info.length_unit, settings
    )


def _made(
    bodies: tuple[Body, Body],
    paths: tuple[Any, Any],
    title: str,
    unit: str,
    settings: TrackSettings,
) -> Scene:
    names = [body.name for body in bodies]
    if names[0] == names[1]:
        names = [f"{names[0]} {which}" for which in "AB"]
    pair = Pair("pair", names[0], names[1], settings)
    motions = [Motion(path, "path", np.zeros(0)) for path in paths]
    return Scene(
        file=Path("run"),
        text="",
        title=title,
        length_unit=unit,
        bodies=dict(zip(names, bodies, strict=True)),
        motions=dict(zip(names, motions, strict=True)),
        pairs=(pair,),
        seen=pair,
        track=settings,
    )
