"""Scenes in TOML: bodies, placements, motions, and tracking settings.

The format is described in ``docs/scene-format.md``.
"""

from typing import TYPE_CHECKING

from standoff.on_demand import on_demand

if TYPE_CHECKING:
    from standoff.scene.errors import SceneError
    from standoff.scene.motions import Motion
    from standoff.scene.run import first_impact, prepare, query, record
    from standoff.scene.scene import Scene, load_scene
    from standoff.scene.settings import TrackSettings
else:
    __getattr__, __dir__ = on_demand(__name__)

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
