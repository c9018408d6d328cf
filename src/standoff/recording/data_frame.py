"""A recording as a data frame of pandas."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import fields
from typing import Any

from standoff.bodies.plain_data import plain
from standoff.errors import of_extra
from standoff.recording.recorded import RecordedFrames
from standoff.tracking.rows import Counts

with of_extra("pandas", "pandas"):
    import pandas as pd

NUMBERS = ("time", "distance", "lower_bound", "upper_bound", "rate", "residual")
VECTORS = ("point_a", "point_b", "normal", "velocity_a", "velocity_b")


def data_frame(recording: RecordedFrames) -> Any:
    """Return one row per frame; `Recording.to_pandas` describes the columns."""
    columns: dict[str, Any] = {name: getattr(recording, name) for name in NUMBERS}
    for name in VECTORS:
        columns |= {f"{name}_{x}": getattr(recording, name)[:, k] for k, x in enumerate("xyz")}
    for side in "ab":
        columns[f"feature_{side}"] = _words(map(str, getattr(recording, f"feature_{side}")))
        parameters = getattr(recording, f"parameters_{side}")
        columns |= {f"parameters_{side}_{k}": parameters[:, k] for k in range(3)}
    columns["status"] = _words(status.name for status in recording.status)
    columns["certified"] = recording.certified
    columns |= {name: recording.counts[:, k] for k, name in enumerate(Counts._fields)}
    table = pd.DataFrame(columns)
    info = recording.info
    table.attrs["standoff"] = {part.name: plain(getattr(info, part.name)) for part in fields(info)}
    return table


def _words(words: Iterable[str]) -> Any:
    return pd.Categorical(list(words))
