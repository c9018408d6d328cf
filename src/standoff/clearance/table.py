"""The near pairs of a tracked world, frame by frame, as a Parquet table."""

from __future__ import annotations

from typing import Any, BinaryIO

import numpy as np

from standoff import parquet
from standoff.parquet import pa
from standoff.scene.scene import Scene
from standoff.scene.settings import TrackSettings
from standoff.scene.worlds import by_piece
from standoff.typing import Array
from standoff.version import __version__
from standoff.world import World, WorldAnswer
from standoff.world.shapes import boundary_of

FORMAT, FORMAT_VERSION = "standoff-world", 1

NUMBERS = ("distance", "lower_bound", "upper_bound")


class NearPairs:
    """What a table holds, gathered frame by frame: a row for each near pair and frame."""

    def __init__(self, world: World) -> None:
        self._world = world
        self._times: list[Array] = []
        self._bodies: list[Any] = []
        self._numbers: dict[str, list[Array]] = {
            "distance": [],
            "lower_bound": [],
            "upper_bound": [],
        }
        self._status: list[Any] = []
        self._certified: list[Any] = []

    def add(self, time: float, answer: WorldAnswer) -> None:
        """Take in a frame."""
        pairs = answer.pairs
        self._times.append(np.full(len(pairs), time))
        self._bodies.append(pairs.bodies)
        for name, columns in self._numbers.items():
            columns.append(getattr(pairs, name))
        self._status.append([status.name for status in pairs.status])
        self._certified.append(pairs.certified)

    def columns(self) -> dict[str, Any]:
        """Return the columns, by name."""
        bodies = np.concatenate(self._bodies).astype(np.int32)
        names = pa.array(list(self._world.bodies))
        found = {"time": np.concatenate(self._times)}
        for side, k in (("a", 0), ("b", 1)):
            numbers = pa.array(bodies[:, k])
            found[side] = pa.DictionaryArray.from_arrays(numbers, names).cast(pa.string())
        found |= {name: np.concatenate(columns) for name, columns in self._numbers.items()}
        found["status"] = pa.array([name for each in self._status for name in each], pa.string())
        found["certified"] = np.concatenate(self._certified)
        return found

    def write(self, scene: Scene, settings: TrackSettings, file: BinaryIO) -> None:
        """Write the table to a stream; the same run gives the same file, byte for byte."""
        parquet.write(self.columns(), self._facts(scene, settings), file)

    def _facts(self, scene: Scene, settings: TrackSettings) -> dict[str, Any]:
        within = self._world.within
        return {
            "format": FORMAT,
            "format_version": FORMAT_VERSION,
            "standoff": __version__,
            "title": scene.title,
            "units": {"length": scene.length_unit, "time": "s"},
            "bodies": {
                name: boundary_of(body).digest
                for name, body in by_piece(self._world.bodies).items()
            },
            "within": within if np.isfinite(within) else None,
            "settings": settings.facts(),
            "notes": scene.notes,
            "scene": scene.file.name,
            "scene_text": scene.text,
        }
