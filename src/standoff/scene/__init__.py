"""Scenes in TOML: bodies, placements, motions, and tracking settings.

The format is described in ``docs/scene-format.md``.
"""

from standoff.scene.errors import SceneError
from standoff.scene.motions import Motion
from standoff.scene.run import first_impact, prepare, query, record
from standoff.scene.scene import Scene, load_scene
from standoff.scene.settings import TrackSettings

__all__ = [
    "Motion",
    "Scene",
    "SceneError",
    "TrackSettings",
    "first_impact",
    "load_scene",
    "prepare",
    "query",
    "record",
]
