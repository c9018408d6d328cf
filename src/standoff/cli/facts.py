"""Results as plain data, for ``--json``."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from standoff import __version__
from standoff.bodies import plain_data

if TYPE_CHECKING:
    from standoff.impact import Impact
    from standoff.recording import RecordedEvent, Recording
    from standoff.scene import Scene, TrackSettings
    from standoff.scene.simulation import SimulationScene
    from standoff.solids.answer import SolidProximity
    from standoff.tracking import Proximity

INDENT = 2
"""Spaces a level of the JSON text."""

ANSWERED = (
    *("time", "distance", "lower_bound", "upper_bound", "point_a", "point_b", "normal"),
    *("feature_a", "feature_b", "parameters_a", "parameters_b", "rate", "residual", "status"),
    *("certified", "counts"),
)
"""Attributes of an answer that are printed, in their order."""


def json_text(facts: Mapping[str, Any]) -> str:
    """Return strict JSON: numbers without a value, such as the distance of an overlap, are null."""
    return plain_data.json_text(facts, INDENT)


def pairs_text(scene: Scene, results: Sequence[Mapping[str, Any]]) -> str:
    """Return the JSON of all results: one pair's by itself, several as a list under ``pairs``."""
    if len(results) == 1:
        return json_text(results[0])
    return json_text(_file_facts(scene) | {"pairs": results})


def simulation_facts(scene: SimulationScene) -> dict[str, Any]:
    """Return which scene, to the letter, a simulation's result belongs to."""
    digest = hashlib.sha256(scene.text.encode()).hexdigest()
    return _file_facts(scene) | {"scene_sha256": digest}


def _file_facts(scene: Scene | SimulationScene) -> dict[str, Any]:
    return {
        "standoff": __version__,
        "scene": scene.file.name,
        "title": scene.title,
        "length_unit": scene.length_unit,
    }


def world_facts(scene: Scene) -> dict[str, Any]:
    """Return which scene a result of its world belongs to."""
    return _file_facts(scene) | {"notes": scene.notes}


def scene_facts(scene: Scene) -> dict[str, Any]:
    """Return which scene and pair a result belongs to."""
    return _file_facts(scene) | {
        "pair": scene.selected.name,
        "a": scene.pair[0],
        "b": scene.pair[1],
        "notes": scene.notes,
    }


OF_SOLIDS = (
    *("distance", "lower_bound", "upper_bound", "slack", "point_a", "point_b", "normal"),
    *("feature_a", "feature_b", "parameters_a", "parameters_b", "minima", "continuum"),
    *("overlap", "inside", "cavity", "smoothness", "status", "certified", "counts"),
)
"""Attributes of an answer of solids that are printed, in their order."""


def answer_facts(scene: Scene, time: float, answer: Proximity | SolidProximity) -> dict[str, Any]:
    """Return one answer."""
    from standoff.solids.answer import SolidProximity

    if isinstance(answer, SolidProximity):
        facts = answer.as_dict()
        return scene_facts(scene) | {"time": time} | {name: facts[name] for name in OF_SOLIDS}
    return scene_facts(scene) | {name: getattr(answer, name) for name in ANSWERED} | {"time": time}


def impact_facts(scene: Scene, found: Impact) -> dict[str, Any]:
    """Return a time of impact, with the answer at that time."""
    return answer_facts(scene, found.time, found.proximity) | {
        "impact": found.status.name,
        "latest": found.latest,
        "clearance": found.clearance,
        "tolerance": found.tolerance,
        "steps": found.steps,
        "evaluations": found.evaluations,
        "queries": found.queries,
    }


def frame_facts(recording: Recording, frame: int | None) -> dict[str, Any] | None:
    """Return one frame of a recording; None where there is no such frame."""
    if frame is None:
        return None
    return {
        "frame": frame,
        "time": float(recording.time[frame]),
        "distance": float(recording.distance[frame]),
        "lower_bound": float(recording.lower_bound[frame]),
        "upper_bound": float(recording.upper_bound[frame]),
        "point_a": recording.point_a[frame],
        "point_b": recording.point_b[frame],
        "normal": recording.normal[frame],
        "feature_a": str(recording.feature_a[frame]),
        "feature_b": str(recording.feature_b[frame]),
        "status": recording.status[frame].name,
    }


def event_facts(events: Iterable[RecordedEvent]) -> list[dict[str, Any]]:
    """Return the switching events."""
    return [
        event._asdict() | {"source": str(event.source), "target": str(event.target)}
        for event in events
    ]


def _minima_facts(recording: Recording) -> dict[str, Any]:
    """Return what becomes of local minima, where they were asked for."""
    if recording.minima is None:
        return {}
    told = [
        event._asdict()
        | {
            "time": float(recording.time[event.frame]),
            "features": [str(feature) for feature in event.features],
            "reason": None if event.reason is None else event.reason.name,
        }
        for event in recording.minima_events
    ]
    return {"minima_events": told}


def recording_facts(
    scene: Scene, settings: TrackSettings, recording: Recording, written: Sequence[Path]
) -> dict[str, Any]:
    """Return the summary of a run, with all events."""
    widest = recording.widest_gap()
    return scene_facts(scene) | {
        "settings": settings.facts(),
        "frames": len(recording.time),
        "start": float(recording.time[0]),
        "end": float(recording.time[-1]),
        "closest": frame_facts(recording, recording.closest()),
        "certified_frames": int(np.count_nonzero(recording.certified)),
        "certified_share": float(np.mean(recording.certified)),
        "worst_gap": None if widest is None else float(recording.gap[widest]),
        "worst_gap_frame": widest,
        "statuses": {status.name: n for status, n in recording.status_frames().items()},
        "counts": recording.total_counts()._asdict(),
        "events": event_facts(recording.events),
        **_minima_facts(recording),
        "files": [str(path) for path in written],
    }
