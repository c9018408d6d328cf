"""Local minima and their events as columns of a recording's file: each frame has a list of structs.

docs/scene-format.md describes them.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.features import feature_told
from standoff.parquet import pa
from standoff.recording.local_minima import LocalMinima, MinimumEvent
from standoff.tracking.branches import Birth, End

POINTS = tuple(f"point_{side}_{x}" for side in "ab" for x in "xyz")
MINIMUM = pa.struct(
    [
        ("key", pa.int64()),
        *((name, pa.float64()) for name in ("distance", "lower_bound", *POINTS)),
        ("feature_a", pa.string()),
        ("feature_b", pa.string()),
    ]
)
EVENT = pa.struct(
    [
        ("kind", pa.string()),
        ("key", pa.int64()),
        ("distance", pa.float64()),
        ("feature_a", pa.string()),
        ("feature_b", pa.string()),
        ("reason", pa.string()),
        ("other", pa.int64()),
    ]
)
REASONS: dict[str, Any] = {"birth": Birth, "end": End}


def minima_columns(
    minima: LocalMinima, events: tuple[MinimumEvent, ...], frames: int
) -> dict[str, Any]:
    """The columns ``minima`` and ``minima_events`` of a recording of so many frames."""
    points = np.concatenate([minima.point_a, minima.point_b], axis=1)
    flat = pa.StructArray.from_arrays(
        [
            pa.array(minima.key),
            pa.array(minima.distance),
            pa.array(minima.lower_bound),
            *(pa.array(points[:, k].copy()) for k in range(len(POINTS))),
            _texts(minima.feature_a),
            _texts(minima.feature_b),
        ],
        fields=list(MINIMUM),
    )
    rows: list[list[dict[str, Any]]] = [[] for _ in range(frames)]
    for event in events:
        a, b = map(str, event.features)
        reason = None if event.reason is None else event.reason.name
        told: dict[str, Any] = {"kind": event.kind, "key": event.key, "distance": event.distance}
        told |= {"feature_a": a, "feature_b": b, "reason": reason, "other": event.other}
        rows[event.frame].append(told)
    first = np.searchsorted(minima.frame, np.arange(frames + 1)).astype(np.int32)
    return {
        "minima": pa.ListArray.from_arrays(pa.array(first), flat),
        "minima_events": pa.array(rows, pa.list_(EVENT)),
    }


def minima_in(table: Any) -> dict[str, Any]:
    """The fields ``minima`` and ``minima_events`` that a table of PyArrow holds; {} if none."""
    if "minima" not in table.column_names:
        return {}
    rows = table["minima"].to_pylist()
    frames = np.repeat(np.arange(len(rows)), [len(row) for row in rows])
    each = [minimum for row in rows for minimum in row]

    def numbers(*names: str) -> NDArray[np.float64]:
        return np.array([[m[name] for name in names] for m in each]).reshape(-1, len(names))

    minima = LocalMinima(
        frames.astype(np.int64),
        np.array([m["key"] for m in each], dtype=np.int64),
        numbers("distance")[:, 0],
        numbers("lower_bound")[:, 0],
        numbers(*POINTS[:3]),
        numbers(*POINTS[3:]),
        _features([m["feature_a"] for m in each]),
        _features([m["feature_b"] for m in each]),
    )
    told = enumerate(table["minima_events"].to_pylist())
    return {
        "minima": minima,
        "minima_events": tuple(_event(frame, event) for frame, row in told for event in row),
    }


def _event(frame: int, told: dict[str, Any]) -> MinimumEvent:
    reason = None if told["reason"] is None else REASONS[told["kind"]][told["reason"]]
    features = feature_told(told["feature_a"]), feature_told(told["feature_b"])
    kind, key, other = told["kind"], told["key"], told["other"]
    return MinimumEvent(frame, kind, key, told["distance"], features, reason, other)


def _texts(features: NDArray[np.object_]) -> Any:
    return pa.array([str(feature) for feature in features], pa.string())


def _features(texts: list[str]) -> NDArray[np.object_]:
    known = {text: feature_told(text) for text in set(texts)}
    objects = np.empty(len(texts), dtype=object)
    objects[:] = [known[text] for text in texts]
    return objects
