"""A recording as a Parquet file: one row a frame; docs/scene-format.md lists the columns."""

from __future__ import annotations

import hashlib
import json
import platform
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numba
import numpy as np

from standoff.cli.errors import MissingExtra
from standoff.cli.facts import event_facts, scene_facts
from standoff.scene import Scene, TrackSettings
from standoff.scene.reader import Array
from standoff.tracking import Counts, Recording

try:
    import pyarrow as pa
    import pyarrow.parquet as pq
except ModuleNotFoundError as error:
    raise MissingExtra("pyarrow") from error

FORMAT = "standoff-recording"
FORMAT_VERSION = 1

EVENT = pa.struct(
    [
        ("time", pa.float64()),
        ("body", pa.string()),
        ("source", pa.string()),
        ("target", pa.string()),
        ("value", pa.float64()),
        ("slope", pa.float64()),
        ("located", pa.bool_()),
    ]
)


def write_table(path: Path, scene: Scene, settings: TrackSettings, recording: Recording) -> None:
    """Write a recording; the same run gives the same file, byte for byte.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    table = pa.table(_columns(recording))
    metadata = json.dumps(run_metadata(scene, settings), ensure_ascii=False)
    pq.write_table(table.replace_schema_metadata({"standoff": metadata}), path)


def run_metadata(scene: Scene, settings: TrackSettings) -> dict[str, Any]:
    """Return what tells a file's reader how it came about, with nothing of the machine's paths."""
    sources = [motion.file for motion in scene.pair_motions if motion.file is not None]
    return {
        "format": FORMAT,
        "format_version": FORMAT_VERSION,
        **scene_facts(scene),
        "scene_text": scene.text,
        "settings": asdict(settings),
        "samples_sha256": {
            file.name: hashlib.sha256(file.read_bytes()).hexdigest() for file in sources
        },
        "versions": {
            "python": platform.python_version(),
            "numpy": np.__version__,
            "numba": numba.__version__,
            "pyarrow": pa.__version__,
        },
    }


def _columns(recording: Recording) -> dict[str, Any]:
    return {
        "time": recording.time,
        "distance": recording.distance,
        "lower_bound": recording.lower_bound,
        **_components("point_a", recording.point_a),
        **_components("point_b", recording.point_b),
        **_components("normal", recording.normal),
        "rate": recording.rate,
        **_components("velocity_a", recording.velocity_a),
        **_components("velocity_b", recording.velocity_b),
        "residual": recording.residual,
        "feature_a": _words(map(str, recording.feature_a)),
        "feature_b": _words(map(str, recording.feature_b)),
        "parameters_a": _parameters(recording.parameters_a),
        "parameters_b": _parameters(recording.parameters_b),
        "status": _words(status.name for status in recording.status),
        "certified": recording.certified,
        **{name: recording.counts[:, k] for k, name in enumerate(Counts._fields)},
        "events": _events(recording),
    }


def _components(name: str, vectors: Array) -> dict[str, Array]:
    return {f"{name}_{axis}": vectors[:, k] for k, axis in enumerate("xyz")}


def _words(words: Any) -> Any:
    return pa.array(list(words), pa.string()).dictionary_encode()


def _parameters(rows: Array) -> Any:
    return pa.array([row[~np.isnan(row)].tolist() for row in rows], pa.list_(pa.float64()))


def _events(recording: Recording) -> Any:
    by_frame: list[list[dict[str, Any]]] = [[] for _ in recording.time]
    for facts in event_facts(recording.events):
        by_frame[facts.pop("frame")].append(facts)
    return pa.array(by_frame, pa.list_(EVENT))
