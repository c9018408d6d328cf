"""`so.view`: the live page from Python and notebooks."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.motion import Fixed, Pose
from standoff.progress import Progress
from standoff.recording import Recording
from standoff.scene import Scene, load_scene
from standoff.scene.file_content import is_simulation
from standoff.scene.motions import Motion
from standoff.scene.pairs import PairOfScene
from standoff.scene.settings import TrackSettings
from standoff.view.minima_asked import MinimaAsked
from standoff.view.moving_world import MovingWorld, moving_world, world_of_scene
from standoff.world import World
from standoff.world.shapes import Shape, as_shape, is_solid

if TYPE_CHECKING:
    from standoff.view.served import ServedPage
    from standoff.view.shown_simulation import Simulated

Shown: TypeAlias = "Scene | MovingWorld | Simulated"
"""What has a page of its own kind."""

GIVE = (
    "give the file of a scene, a Scene, a Recording that so.track returned, two bodies or solids "
    "with their poses, a World with poses, a World with paths and a duration, a SystemRun with its "
    "contacts, or an Operator"
)


def view(
    *what: Any,
    host: str = "127.0.0.1",
    port: int | None = None,
    open: bool = True,
    minima: float | None = None,
    patch: float | None = None,
) -> ServedPage:
    """Show a scene, a run, a pair of bodies, a world or a simulation (docs/live-page.md).

    Raises ModuleNotFoundError if viser is not installed; the message names the extra. Raises
    TypeError if that cannot be shown. Raises ValueError if a scene is refused, the pair cannot be
    tracked, or the port is not available; if minima or patches are asked of what is no pair with a
    solid.

    Parameters
    ----------
    *what
        The file of a scene, a Scene, or a Recording that ``so.track`` returned; or two bodies or
        solids and where they are, ``so.view(a, b, pose_a, pose_b)``; or a World and where its
        moving bodies are, ``so.view(world, poses)``, or how they move, ``so.view(world, paths,
        duration)`` with a mapping of names to paths and a time [s]. A scene with a ``[world]`` is
        shown as one. Of a simulation a SystemRun that has kept its contacts, which is played, or an
        Operator, ``so.view(operator)`` or ``so.view(operator, state)``, which is stepped; the file
        of a simulation is run first.
    host : str
        Name or address to serve the page at; only this machine, if not given.
    port : int, optional
        Any that is free, if not given.
    open : bool
        Open the page in the usual browser.
    minima : float, optional
        Of a pair with a solid: the distance below which local minima are shown [length]; 0.3 of
        the smaller one's size, if not given.
    patch : float, optional
        Of such a pair: each minimum with its patch, as of ``so.solids.distance`` [length].

    Returns
    -------
    ServedPage
        It serves until ``close``, or until the end of its ``with`` block; open its ``address``. In
        a notebook it shows itself.
    """
    asked = MinimaAsked(minima, patch)
    page = page_of(_shown(what), host=host, port=port, asked=asked)
    if open:
        import webbrowser

        webbrowser.open(page.address)
    return page


def page_of(
    what: Shown,
    *,
    host: str,
    port: int | None,
    others: Mapping[str, Path] | None = None,
    asked: MinimaAsked | None = None,
) -> ServedPage:
    """Return the page of a scene's pair, of a world or of a simulation, served.

    Raises ModuleNotFoundError, TypeError, ValueError as `view`.

    Parameters
    ----------
    what : Scene, MovingWorld or Simulated
    host, port
        As of `view`.
    others : mapping of str to Path, optional
        Scenes of pairs that the page of a pair of bodies can open besides, by title.
    asked : MinimaAsked, optional
        Of a pair with a solid.
    """
    if isinstance(what, Scene) and has_solids(what):
        from standoff.view.solid_page import SolidPage

        return SolidPage(what, asked, host=host, port=port)
    for name, value in (asked or MinimaAsked())._asdict().items():
        if value is not None:
            raise StandoffError(
                f"{name} = {shown(value)}: this page is of no pair with a solid; leave it out.",
                name,
                value,
            )
    if isinstance(what, Scene):
        from standoff.view.page import Page

        return Page(what, host=host, port=port, others=others)
    if not isinstance(what, MovingWorld):
        from standoff.view.simulation_page import SimulationPage

        return SimulationPage(what, host=host, port=port)
    from standoff.view.world_page import WorldPage

    return WorldPage(what, host=host, port=port)


def has_solids(scene: Scene) -> bool:
    """Is a scene seen through a pair of which at least one is a solid?"""
    return any(is_solid(shape) for shape in scene.pair_shapes)


def of_scene(scene: Scene) -> Scene | MovingWorld:
    """Return the world of a scene that has a ``[world]``; of another, the scene itself."""
    if scene.rules is None:
        return scene
    return world_of_scene(scene)


def simulation_of(file: str | os.PathLike[str], progress: Progress | None = None) -> Simulated:
    """Run the scene of a simulation, and return it with all its contacts.

    Raises SceneError if the scene is not usable, or the motion left all bounds.

    Parameters
    ----------
    file : str or path
    progress : callable, optional
        As of ``Operator.run``.
    """
    from standoff.scene.simulation import load_simulation
    from standoff.view.shown_simulation import Simulated

    scene = load_simulation(file)
    run = scene.run(progress, contacts=True)
    return Simulated(run, scene.title, scene.length_unit, scene.names)


def _shown(what: tuple[Any, ...]) -> Shown:
    match what:
        case (Scene() as scene,):
            return of_scene(scene)
        case (str() | os.PathLike() as file,):
            return simulation_of(file) if is_simulation(file) else of_scene(load_scene(file))
        case (Recording() as recording,):
            return scene_of(recording)
        case (World() as world, poses):
            return moving_world(world, poses)
        case (World() as world, paths, duration):
            return moving_world(world, paths, duration)
        case (a, b, pose_a, pose_b) if (pair := _pair(a, b)) is not None:
            paths = Fixed(Pose.of(pose_a)), Fixed(Pose.of(pose_b))
            return _made(pair, paths, "Two bodies", "", TrackSettings())
    found = _simulation(what)
    if found is not None:
        return found
    raise StandoffTypeError(f"{shown(what)} cannot be shown: {GIVE}.", "what", what)


def _simulation(what: tuple[Any, ...]) -> Simulated | None:
    """A run, or an operator with a state or at its start; None of anything else."""
    from standoff.simulation import Operator, SystemRun, SystemState
    from standoff.view.shown_simulation import simulated

    match what:
        case (SystemRun() as run,):
            return simulated(run)
        case (Operator() as operator,):
            return simulated((operator, operator.start()))
        case (Operator() as operator, SystemState() as state):
            return simulated((operator, state))
    return None


def _pair(a: Any, b: Any) -> tuple[Shape, Shape] | None:
    """Two bodies or solids; None of anything else."""
    shapes = as_shape(a), as_shape(b)
    return None if any(shape is None for shape in shapes) else shapes


@dataclass(frozen=True)
class _PathStretch:
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

    Raises StandoffError if it was opened from a file or copied: it does not hold what moved then.

    Parameters
    ----------
    recording : Recording
    """
    if recording.pair is None or recording.paths is None:
        raise StandoffError(
            "A recording that was opened from a file, copied or unpickled does not hold what "
            "moved: show the one that so.track returned.",
            "what",
            recording,
        )
    if recording.info.of_solids:
        raise StandoffError(
            "The live page of a recording takes convex bodies alone, and one of these is a solid "
            "that need not be: standoff.view.export.save_page(recording, 'run.html') shows the "
            "motion, and so.view of the scene follows it.",
            "what",
            recording,
        )
    first, last = (float(recording.time[k]) for k in (0, -1))
    ends = [
        path if isinstance(path, Fixed) else _PathStretch(path, first, last)
        for path in recording.paths
    ]
    step = float(np.diff(recording.time).max())
    settings = TrackSettings(recording.info.law, step, first, last - first)
    info = recording.info
    return _made(
        recording.pair, (ends[0], ends[1]), info.title or "A run", info.length_unit, settings
    )


def _made(
    bodies: tuple[Shape, Shape],
    paths: tuple[Any, Any],
    title: str,
    unit: str,
    settings: TrackSettings,
) -> Scene:
    names = [body.name for body in bodies]
    if names[0] == names[1]:
        names = [f"{names[0]} {which}" for which in "AB"]
    pair = PairOfScene("pair", names[0], names[1], settings)
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
