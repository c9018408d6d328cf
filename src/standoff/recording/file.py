"""A recording as a Parquet file: one row per frame; docs/scene-format.md lists the columns."""

from __future__ import annotations

import json
import math
import os
import platform
from collections.abc import Iterable
from pathlib import Path
from typing import Any, BinaryIO

import numba
import numpy as np
from numpy.typing import NDArray

from standoff import parquet
from standoff.bodies.features import feature_told
from standoff.checks.real_numbers import SHOWN_CHARACTERS, shown
from standoff.errors import StandoffError
from standoff.nesting import JSON, text_problem, value_problem
from standoff.parquet import pa, pq
from standoff.recording.recorded import RecordedEvent, RecordedFrames, RunInfo
from standoff.recording.stored_minima import minima_columns, minima_in
from standoff.tracking.law_options import options_of
from standoff.tracking.laws import LAWS, PaperLaw, every_option
from standoff.tracking.rows import Counts
from standoff.tracking.status import Status
from standoff.typing import Array

FORMAT = "standoff-recording"
FORMAT_VERSION = 4
"""2 since events are located: their value is that of the switching function. 3 since there are
the column `upper_bound` and the options `depth` and `deadline`. 4 since the options are those of
the law that was followed, and no other's."""

VERSION_OF_SOLIDS = 5
"""That of a run of solids, whose statuses, options and minima an older Standoff does not know. A
run of convex bodies stays of a version that it reads."""

READ_VERSIONS = (2, 3, 4, 5)
"""What a file of version 2 does not hold is not made up: its upper bounds are nan, and its options
have no `depth` and no `deadline`."""

LAWS_OWN = 4
"""From this version on the options are the law's own."""

NUMBERS = ("distance", "lower_bound", "upper_bound", "rate", "residual")
VECTORS = ("point_a", "point_b", "normal", "velocity_a", "velocity_b")

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


NAMED = 3
"""Most keys that a message gives of a place in the metadata."""


def write_table(recording: RecordedFrames, file: BinaryIO) -> None:
    """Write a recording to a stream; the same run gives the same file, byte for byte.

    Raises OSError if the file cannot be written. Raises TypeError if ``info`` holds what JSON
    cannot. Raises ValueError if ``info`` is nested too deeply.
    """
    pq.write_table(table_of(recording), file)


def table_of(recording: RecordedFrames) -> Any:
    """Return a recording as a table of PyArrow, with its metadata.

    Raises TypeError if ``info`` holds what JSON cannot. Raises ValueError if ``info`` is nested too
    deeply.
    """
    facts = _metadata(recording.info)
    problem, keys = value_problem(facts)
    if problem:
        raise StandoffError(f"the recording's info ({'.'.join(keys[:NAMED])}) {problem}")
    return parquet.table(_columns(recording), facts)


def _metadata(info: RunInfo) -> dict[str, Any]:
    return {
        "format": FORMAT,
        "format_version": VERSION_OF_SOLIDS if info.of_solids else FORMAT_VERSION,
        "standoff": info.version,
        "title": info.title,
        "a": info.bodies[0],
        "b": info.bodies[1],
        "a_sha256": info.digests[0],
        "b_sha256": info.digests[1],
        "units": {"length": info.length_unit, "time": "s", "angle": "rad"},
        # JSON has no infinity, and a tolerance may be infinite.
        "options": {k: "inf" if v == math.inf else v for k, v in info.options.items()},
        "source": dict(info.source),
        "repaired": info.repaired,
        "versions": {
            "python": platform.python_version(),
            "numpy": np.__version__,
            "numba": numba.__version__,
            "pyarrow": pa.__version__,
        },
    }


def _columns(recording: RecordedFrames) -> dict[str, Any]:
    columns: dict[str, Any] = {"time": recording.time}
    columns |= {name: getattr(recording, name) for name in NUMBERS}
    for name in VECTORS:
        columns |= {f"{name}_{x}": getattr(recording, name)[:, k] for k, x in enumerate("xyz")}
    columns |= {
        "feature_a": _words(map(str, recording.feature_a)),
        "feature_b": _words(map(str, recording.feature_b)),
        "parameters_a": _parameters(recording.parameters_a),
        "parameters_b": _parameters(recording.parameters_b),
        "status": _words(status.name for status in recording.status),
        "certified": recording.certified,
        **{name: recording.counts[:, k] for k, name in enumerate(Counts._fields)},
        "events": _events(recording),
    }
    if recording.minima is not None:
        columns |= minima_columns(recording.minima, recording.minima_events, len(recording))
    return columns


def _words(words: Iterable[str]) -> Any:
    return pa.array(list(words), pa.string()).dictionary_encode()


def _parameters(rows: Array) -> Any:
    return pa.array([row[~np.isnan(row)].tolist() for row in rows], pa.list_(pa.float64()))


def _events(recording: RecordedFrames) -> Any:
    by_frame: list[list[dict[str, Any]]] = [[] for _ in recording.time]
    for event in recording.events:
        words = {"source": str(event.source), "target": str(event.target)}
        by_frame[event.frame].append(event._asdict() | words)
    return pa.array(by_frame, pa.list_(EVENT))


def read_table(path: Path) -> dict[str, Any]:
    """Read the fields of a recording; see `open_recording`."""
    # Unlike a path's own `is_file`, this one takes names that no file can have, such as a long one.
    if not os.path.isfile(path):
        what = "is a folder" if os.path.isdir(path) else "does not exist"
        named = path if len(str(path)) <= SHOWN_CHARACTERS else shown(str(path))
        raise FileNotFoundError(f"{named} {what}: name a recording's Parquet file")
    try:
        metadata = _checked(path, pq.read_schema(path).metadata or {})
        table = pq.read_table(path)
    except (pa.ArrowException, UnicodeDecodeError) as error:
        raise StandoffError(
            f"{path} is not a Parquet file, or is truncated or damaged: {error}", "path", path
        ) from error
    except OSError as error:  # damaged pages; nothing else tells them from a disk's failure
        raise StandoffError(
            f"{path} cannot be read; it may be damaged: {error}", "path", path
        ) from error
    try:
        return _fields(table, _info(metadata), metadata["format_version"])
    except (KeyError, IndexError, TypeError, ValueError, AttributeError) as error:
        raise StandoffError(
            f"{path} is marked as a recording, but its content does not fit ({error!r}): another "
            "program may have changed it; record again",
            "path",
            path,
        ) from error


def _checked(path: Path, metadata: dict[bytes, bytes]) -> dict[str, Any]:
    """Return a recording's metadata, or say why the file is none."""
    try:
        text = metadata[parquet.METADATA].decode()
        if text_problem(text, JSON):
            raise StandoffError("no metadata of ours")
        content = json.loads(text)
        kind, version = content["format"], content["format_version"]
    except (KeyError, TypeError, ValueError):
        kind, content, version = None, {}, None
    if kind != FORMAT:
        raise StandoffError(
            f"{path} is a Parquet file but not a Standoff recording: write one with "
            "recording.save or `standoff track -o`",
            "path",
            path,
        )
    if type(version) is not int or version not in READ_VERSIONS:
        older = isinstance(version, int) and version < FORMAT_VERSION
        fix = "record again" if older else "install the Standoff that wrote it"
        raise StandoffError(
            f"{path} is a recording of format version {version!r}, written by Standoff "
            f"{content.get('standoff', '(unknown)')}; this Standoff reads versions "
            f"{', '.join(map(str, READ_VERSIONS[:-1]))} and {READ_VERSIONS[-1]}: {fix}",
            "path",
            path,
        )
    return dict(content)


def _info(metadata: dict[str, Any]) -> RunInfo:
    options = {k: math.inf if v == "inf" else v for k, v in metadata["options"].items()}
    if metadata["format_version"] < LAWS_OWN:
        options = _of_its_law(options)
    return RunInfo(
        (metadata["a"], metadata["b"]),
        (metadata["a_sha256"], metadata["b_sha256"]),
        options,
        metadata["title"],
        metadata["units"]["length"],
        metadata["standoff"],
        metadata["source"],
        metadata.get("repaired", 0),  # before 0.2 a rounded pose was refused
    )


def _of_its_law(options: dict[str, Any]) -> dict[str, Any]:
    """The options of an older file without those that its law does not have."""
    law = LAWS[options["law"]]
    found = {n: x for n, x in options.items() if n in options_of(law) or n not in every_option()}
    if law is PaperLaw:
        found["feedforward"] = options["predictor"] != "none"
        if str(options.get("feedback", "Linear(")).startswith("Linear("):
            found["feedback"] = None  # the gain says it
        else:
            found["gain"] = None
    return found


def _fields(table: Any, info: RunInfo, version: int) -> dict[str, Any]:
    def numbers(name: str) -> Array:
        return np.asarray(table[name].to_numpy(), dtype=np.float64)

    def vectors(name: str) -> Array:
        return np.column_stack([numbers(f"{name}_{axis}") for axis in "xyz"])

    def counted(name: str) -> Any:
        # a recording from before there were saturations has none
        return table[name].to_numpy() if name in table.column_names else np.zeros(len(table))

    counts = np.column_stack([counted(name) for name in Counts._fields])
    return {
        "time": numbers("time"),
        "distance": numbers("distance"),
        "lower_bound": numbers("lower_bound"),
        "upper_bound": numbers("upper_bound") if version > 2 else np.full(len(table), np.nan),
        "rate": numbers("rate"),
        "residual": numbers("residual"),
        "point_a": vectors("point_a"),
        "point_b": vectors("point_b"),
        "normal": vectors("normal"),
        "velocity_a": vectors("velocity_a"),
        "velocity_b": vectors("velocity_b"),
        "feature_a": _meanings(table["feature_a"].to_pylist(), feature_told),
        "feature_b": _meanings(table["feature_b"].to_pylist(), feature_told),
        "parameters_a": _filled(table["parameters_a"].to_pylist()),
        "parameters_b": _filled(table["parameters_b"].to_pylist()),
        "status": _meanings(table["status"].to_pylist(), Status.__getitem__),
        "counts": counts.astype(np.int64),
        "events": _events_of(table["events"].to_pylist()),
        "info": info,
        **minima_in(table),
    }


def _meanings(words: list[str], meaning: Any) -> NDArray[np.object_]:
    known = {word: meaning(word) for word in set(words)}
    objects = np.empty(len(words), dtype=object)
    objects[:] = [known[word] for word in words]
    return objects


def _filled(rows: list[list[float]]) -> Array:
    parameters = np.full((len(rows), 3), np.nan)
    for k, row in enumerate(rows):
        parameters[k, : len(row)] = row
    return parameters


def _events_of(rows: list[list[dict[str, Any]]]) -> tuple[RecordedEvent, ...]:
    return tuple(
        RecordedEvent(
            frame,
            **event | {end: feature_told(event[end]) for end in ("source", "target")},
        )
        for frame, row in enumerate(rows)
        for event in row
    )
