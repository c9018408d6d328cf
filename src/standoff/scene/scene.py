"""A scene: bodies, where they are, how they move, and which pairs of them are tracked."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from standoff.bodies.body import Body
from standoff.motion import Pose
from standoff.scene.errors import SceneError
from standoff.scene.file_content import PAIR_KEYS, SIMULATION_KEYS, FileContent, read_content
from standoff.scene.frames import check_instant, frame_times, start_time, time_window
from standoff.scene.motions import Motion, at_rest, read_motion
from standoff.scene.pairs import Pair, read_pairs
from standoff.scene.reader import Array, Table, unknown_name
from standoff.scene.settings import TrackSettings


@dataclass(frozen=True, eq=False)
class Scene:
    """What a scene file says, checked and built, seen through one of its pairs.

    `query` and `record` work on the selected pair; `each` gives the scene once for every pair.

    Attributes
    ----------
    file : Path
        The scene file.
    text : str
        Its content.
    title : str
        A line for the reader; the file's name where the scene has none.
    length_unit : str
        Label of lengths; no number is converted.
    bodies : mapping of str to Body
    motions : mapping of str to Motion
        One for each body; bodies at rest have the kind ``fixed``.
    pairs : tuple of Pair
        At least one, in the file's order; their names differ.
    selected : Pair
        The pair that the properties below refer to; `load_scene` selects the first.
    """

    file: Path
    text: str
    title: str
    length_unit: str
    bodies: Mapping[str, Body]
    motions: Mapping[str, Motion]
    pairs: tuple[Pair, ...]
    selected: Pair

    @property
    def pair(self) -> tuple[str, str]:
        """Names of the bodies A and B."""
        return self.selected.a, self.selected.b

    @property
    def settings(self) -> TrackSettings:
        """How the pair is tracked: the ``[track]`` table, with the pair's own values over it."""
        return self.selected.settings

    def select(self, name: str) -> Scene:
        """Return the same scene seen through the pair of that name.

        Raises
        ------
        SceneError
            If no pair has it.
        """
        for pair in self.pairs:
            if pair.name == name:
                return replace(self, selected=pair)
        known = [pair.name for pair in self.pairs]
        raise SceneError(unknown_name(name, known, "pair"), key="pairs", file=self.file)

    def each(self) -> tuple[Scene, ...]:
        """Return the scene once for every pair, in the file's order."""
        return tuple(replace(self, selected=pair) for pair in self.pairs)

    @property
    def notes(self) -> list[str]:
        """What was repaired in the pair's input, one sentence each."""
        return [
            f"{motion.repaired} rotations of {name} were rounded; replaced by the nearest ones"
            for name, motion in zip(self.pair, self.pair_motions, strict=True)
            if motion.repaired
        ]

    @property
    def pair_bodies(self) -> tuple[Body, Body]:
        """Bodies A and B."""
        return self.bodies[self.pair[0]], self.bodies[self.pair[1]]

    @property
    def pair_motions(self) -> tuple[Motion, Motion]:
        """Motions of A and B."""
        return self.motions[self.pair[0]], self.motions[self.pair[1]]

    def times(self, settings: TrackSettings | None = None) -> Array:
        """Return the frame times [s] of a run, shape (n,), see `frame_times`."""
        try:
            return frame_times(settings or self.settings, self.pair_motions)
        except SceneError as error:
            raise error.found_in(self.file) from error

    def window(self, settings: TrackSettings | None = None) -> tuple[float, float]:
        """Return the times [s] between which the pair is looked at, see `time_window`."""
        try:
            return time_window(settings or self.settings, self.pair_motions)
        except SceneError as error:
            raise error.found_in(self.file) from error

    def instant(self, time: float | None = None) -> float:
        """Return `time` [s] if it is one of the scene's, see `check_instant`; None: the first
        frame's."""
        try:
            if time is None:
                return start_time(self.settings, self.pair_motions)
            return check_instant(time, self.settings, self.pair_motions)
        except SceneError as error:
            raise error.found_in(self.file) from error


def load_scene(file: str | os.PathLike[str]) -> Scene:
    """Read, check and build a scene.

    Parameters
    ----------
    file : str or path
        A TOML file; the files that it names are relative to its folder.

    Returns
    -------
    Scene

    Raises
    ------
    SceneError
        If the file is missing or is not TOML, or anything in it is unknown, missing, of the wrong
        type or shape, not finite, or refused by the shape, pose or motion that it describes. The
        message names the file, the key and the fix.
    """
    content = read_content(file, PAIR_KEYS, _refuse_simulation)
    pairs = read_pairs(content.top, list(content.bodies))
    return Scene(
        file=content.file,
        text=content.text,
        title=content.title,
        length_unit=content.length_unit,
        bodies=content.bodies,
        motions={name: _motion(name, content) for name in content.bodies},
        pairs=pairs,
        selected=pairs[0],
    )


def _refuse_simulation(top: Table) -> None:
    """Name the command for a file of the other kind, if that is what it is."""
    found = [key for key in SIMULATION_KEYS if key in top]
    if found and "pair" not in top and "pairs" not in top:
        raise top.error(
            "this is the scene of a simulation: `standoff simulate` runs it, and draws it with "
            f"--plot; the scene of a pair has no [{found[0]}]",
            found[0],
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
