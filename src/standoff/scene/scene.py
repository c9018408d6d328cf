"""A scene: bodies, where they are, how they move, and which pairs of them count."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from standoff.bodies.body import Body
from standoff.motion import Pose
from standoff.scene.errors import SceneError
from standoff.scene.file_content import PAIR_KEYS, FileContent, of_a_simulation, read_content
from standoff.scene.frames import check_instant, frame_times, start_time, time_window
from standoff.scene.motions import Motion, at_rest, read_motion
from standoff.scene.pairs import PairOfScene, read_pairs
from standoff.scene.reader import SceneTable, shown, unknown_name
from standoff.scene.settings import DEFAULT_STEP, TrackSettings, read_settings
from standoff.scene.worlds import WorldRules, made_world, read_world
from standoff.typing import Array
from standoff.world import Compound, World
from standoff.world.shapes import Shape


@dataclass(frozen=True, eq=False)
class Scene:
    """What a scene file says, checked and built, seen through one of its pairs, or as a world.

    `query` and `record` work on the selected pair; `each` gives the scene once for every pair.
    Without a selected pair, settings and times are those of the world.

    Attributes
    ----------
    file : Path
        The scene file.
    text : str
        Its content.
    title : str
        A line for the reader; the file's name where the scene has none.
    length_unit : str
        Label of lengths; no number of the scene is converted, lengths of CAD files are.
    bodies : mapping of str to Body, Solid or Compound
    motions : mapping of str to Motion
        One for each body; bodies at rest have the kind ``fixed``.
    pairs : tuple of PairOfScene
        In the file's order; their names differ. None only where there is a ``[world]``.
    seen : PairOfScene or None
        The selected pair; `load_scene` selects the first, if there is one.
    track : TrackSettings
        Those of ``[track]``.
    rules : WorldRules or None
        Those of ``[world]``.
    """

    file: Path
    text: str
    title: str
    length_unit: str
    bodies: Mapping[str, Shape | Compound]
    motions: Mapping[str, Motion]
    pairs: tuple[PairOfScene, ...]
    seen: PairOfScene | None
    track: TrackSettings = field(default_factory=TrackSettings)
    rules: WorldRules | None = None

    @property
    def selected(self) -> PairOfScene:
        """The pair that the properties below refer to.

        Raises SceneError if the scene has a world and no pair.
        """
        if self.seen is None:
            raise SceneError(
                "this scene has a [world] and no [pair]: `standoff clearance` reports on all its "
                "pairs, and `standoff track` follows them; for this, add a [pair]",
                key="world",
                file=self.file,
            )
        return self.seen

    @property
    def pair(self) -> tuple[str, str]:
        """Names of the bodies A and B."""
        return self.selected.a, self.selected.b

    @property
    def settings(self) -> TrackSettings:
        """How the pair is tracked: the ``[track]`` table, with the pair's own values over it."""
        return self.track if self.seen is None else self.seen.settings

    def select(self, name: str) -> Scene:
        """Return the same scene seen through the pair of that name.

        Raises SceneError if no pair has it.
        """
        for pair in self.pairs:
            if pair.name == name:
                return replace(self, seen=pair)
        known = [pair.name for pair in self.pairs]
        raise SceneError(unknown_name(name, known, "pair"), key="pairs", file=self.file)

    def each(self) -> tuple[Scene, ...]:
        """Return the scene once for every pair, in the file's order.

        Raises SceneError if it has none.
        """
        if not self.pairs:
            return (replace(self, seen=self.selected),)
        return tuple(replace(self, seen=pair) for pair in self.pairs)

    @property
    def notes(self) -> list[str]:
        """What was repaired in the input, the pair's or the world's, one sentence each."""
        names = list(self.motions) if self.seen is None else self.pair
        return [
            f"{motion.repaired} rotations of {name} were rounded; replaced by the nearest ones"
            for name, motion in zip(names, self.seen_motions, strict=True)
            if motion.repaired
        ]

    @property
    def pair_bodies(self) -> tuple[Body, Body]:
        """Bodies A and B, where only convex ones go.

        Raises SceneError if one of them is a solid that need not be convex.
        """
        a, b = self.pair_shapes
        for name, body in zip(self.pair, (a, b), strict=True):
            if not isinstance(body, Body):
                raise SceneError(
                    f"{shown(name)} is a solid that need not be convex, and this takes convex "
                    "bodies alone: `standoff track` tracks it, with --export run.html a page of "
                    "the motion, `standoff distance` asks one instant, and `standoff impact` the "
                    "first contact",
                    key=f"bodies.{name}",
                    file=self.file,
                )
        assert isinstance(a, Body)
        assert isinstance(b, Body)
        return a, b

    @property
    def pair_shapes(self) -> tuple[Shape, Shape]:
        """Bodies or solids A and B."""
        a, b = (self.bodies[name] for name in self.pair)
        # `read_pairs` lets no compound in.
        assert not isinstance(a, Compound)
        assert not isinstance(b, Compound)
        return a, b

    @property
    def pair_motions(self) -> tuple[Motion, Motion]:
        """Motions of A and B."""
        return self.motions[self.pair[0]], self.motions[self.pair[1]]

    @property
    def seen_motions(self) -> tuple[Motion, ...]:
        """Motions of A and B, or of all bodies of the world."""
        return tuple(self.motions.values()) if self.seen is None else self.pair_motions

    @property
    def as_world(self) -> Scene:
        """The same scene with no pair selected: settings and times are those of the world."""
        return replace(self, seen=None)

    @cached_property
    def world(self) -> World:
        """The bodies and which pairs of them count, by ``[world]``; without one, the scene's pairs.

        Raises SceneError if the bodies are no world.
        """
        return self.world_with()

    def world_with(
        self,
        within: float | None = None,
        settings: TrackSettings | None = None,
        times: Array | None = None,
    ) -> World:
        """Return the world with another horizon or law.

        Raises SceneError if the bodies are no world, as with two half-spaces that would be a pair.

        Parameters
        ----------
        within : float, optional
            The horizon [length]; the scene's own if not given.
        settings : TrackSettings, optional
            With the law; the scene's own if not given.
        times : (n,) array, optional
            Of the frames, if it is tracked [s]: the law's gain must hold for the longest step.
        """
        rules, bodies = self.rules, self.bodies
        if rules is None:
            rules = WorldRules(only=tuple((pair.a, pair.b) for pair in self.pairs))
            named = {name for pair in self.pairs for name in (pair.a, pair.b)}
            bodies = {name: body for name, body in bodies.items() if name in named}
        if within is not None:
            rules = replace(rules, within=within)
        law = (settings or self.track).law
        dt = DEFAULT_STEP if times is None else float(np.diff(times).max())
        try:
            return made_world(rules, bodies, self.motions, law, dt)
        except (ValueError, TypeError) as error:
            raise SceneError(str(error), key="world", file=self.file) from error

    def poses(self, world: World, time: float) -> dict[str, Pose]:
        """Return the world poses of a world's moving bodies at a scene time [s], by name."""
        return {name: self.motions[name].path.pose(time) for name in world.moving}

    def times(self, settings: TrackSettings | None = None) -> Array:
        """Return the frame times [s] of a run, shape (n,), see `frame_times`."""
        try:
            return frame_times(settings or self.settings, self.seen_motions)
        except SceneError as error:
            raise error.found_in(self.file) from error

    def window(self, settings: TrackSettings | None = None) -> tuple[float, float]:
        """Return the times [s] between which the pair is looked at, see `time_window`."""
        try:
            return time_window(settings or self.settings, self.seen_motions)
        except SceneError as error:
            raise error.found_in(self.file) from error

    def instant(self, time: float | None = None) -> float:
        """Return `time` [s] if it is one of the scene's, see `check_instant`; None: the first
        frame's."""
        try:
            if time is None:
                return start_time(self.settings, self.seen_motions)
            return check_instant(time, self.settings, self.seen_motions)
        except SceneError as error:
            raise error.found_in(self.file) from error


def load_scene(file: str | os.PathLike[str]) -> Scene:
    """Read, check and build a scene.

    Raises SceneError if the file is missing or is not TOML, or anything in it is unknown, missing,
    of the wrong type or shape, not finite, or refused by the shape, pose or motion that it
    describes. The message names the file, the key and the fix.

    Parameters
    ----------
    file : str or path
        A TOML file; the files that it names are relative to its folder.

    Returns
    -------
    Scene
    """
    content = read_content(file, PAIR_KEYS, _refuse_simulation)
    top, bodies = content.top, content.bodies
    compounds = [name for name, body in bodies.items() if isinstance(body, Compound)]
    pairs = read_pairs(top, list(bodies), compounds)
    return Scene(
        file=content.file,
        text=content.text,
        title=content.title,
        length_unit=content.length_unit,
        bodies=content.bodies,
        motions={name: _motion(name, content) for name in content.bodies},
        pairs=pairs,
        seen=pairs[0] if pairs else None,
        track=_track(top, pairs),
        rules=read_world(top, bodies, list(content.motions)),
    )


def _track(top: SceneTable, pairs: tuple[PairOfScene, ...]) -> TrackSettings:
    """Settings of the world: what the pairs of a scene without one override is not read here."""
    if "world" not in top:
        return pairs[0].settings
    return read_settings(*((top.table("track"),) if "track" in top else ()))


def _refuse_simulation(top: SceneTable) -> None:
    """Name the command for a file of the other kind, if that is what it is."""
    found = of_a_simulation(top)
    if found is not None:
        raise top.error(
            "this is the scene of a simulation: `standoff simulate` runs it, and `standoff view` "
            f"shows it; the scene of a pair has no [{found}]",
            found,
        )


def _motion(name: str, content: FileContent) -> Motion:
    placement = content.placements.get(name)
    if name in content.motions:
        motion = read_motion(content.motions[name], placement)
    else:
        motion = at_rest(placement or Pose.identity())
    if placement is not None and placement.repaired:
        motion = replace(motion, repaired=motion.repaired + 1)
    return motion
