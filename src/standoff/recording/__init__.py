"""Runs of a tracker along two paths, as they are recorded, stored and drawn."""

from typing import TYPE_CHECKING

from standoff.on_demand import on_demand

if TYPE_CHECKING:
    from standoff.recording.recorded import RecordedEvent, RunInfo
    from standoff.recording.recording import Recording, open_recording
    from standoff.recording.track import track
else:
    __getattr__, __dir__ = on_demand(__name__)

__all__ = [
    "RecordedEvent",
    "Recording",
    "RunInfo",
    "open_recording",
    "track",
]
