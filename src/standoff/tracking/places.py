"""Places on bodies, as users give them: a feature and its parameters."""

from __future__ import annotations

import operator
from typing import Any

import numpy as np

from standoff.bodies.body import Body
from standoff.bodies.features import Feature, charts_of
from standoff.checks.real_numbers import check_readable, real_array, shown
from standoff.errors import StandoffError, UnreadableNumbers
from standoff.kernels.entries.queries import on_face
from standoff.tracking.rows import StateRow
from standoff.typing import Array

PlaceLike = tuple[Feature | tuple[str, int], Any]
"""A feature and its parameters."""


def put(state: StateRow, side: int, body: Body, place: PlaceLike) -> None:
    """Put the witness point of A (0) or B (1) on a place in a state.

    Raises ValueError: not a pair of feature and parameters, no such feature, or parameters outside
    it.
    """
    feature, parameters = _two(place, ("place_a", "place_b")[side])
    kind, index = _feature_of(body, feature)
    values = _values_of(body, kind, index, parameters)
    offset = {"face": 0, "edge": body.n_faces, "vertex": body.n_faces + body.n_edges}[kind]
    chart = _chart_of(body, index, values) if kind == "face" else -1
    if kind == "edge":
        curve = body.edge_parts[index].curve
        if not curve.closed and not curve.first <= values[0] <= curve.last:
            raise StandoffError(
                f"Parameter {values[0]} lies outside edge {index}: [{curve.first}, {curve.last}].",
                "parameters",
                parameters,
            )
    state.place(side, offset + index, chart, values[: COUNT[kind]])


COUNT = {"face": 2, "edge": 1, "vertex": 0}
"""Parameters of a feature, without the number of the chart."""


def _two(place: Any, name: str) -> tuple[Any, Any]:
    # ("face", 0) has two parts as well: a feature without its parameters
    pair = isinstance(place, tuple | list) and len(place) == 2
    if not pair or isinstance(place[0], str):
        raise StandoffError(
            f"{name} = {shown(place)}: give (feature, parameters), "
            "such as (('face', 0), (0.1, 0.2)).",
            name,
            place,
        )
    return place[0], place[1]


def _feature_of(body: Body, feature: Any) -> tuple[str, int]:
    """Kind and number of a feature that the body has."""
    try:
        kind, index = feature
        check_readable(index)
        index = operator.index(index)
    except (TypeError, ValueError) as error:
        raise StandoffError(
            f"{shown(feature)} is not a feature: give so.Feature('face', 0) or ('face', 0).",
            "feature",
            feature,
        ) from error
    sizes = {"face": body.n_faces, "edge": body.n_edges, "vertex": body.n_vertices}
    if kind not in sizes or not 0 <= index < sizes[kind]:
        raise StandoffError(
            f"{body!r} has no {kind} {index}: faces, edges and vertices are numbered from 0.",
            "feature",
            feature,
        )
    return kind, index


def _values_of(body: Body, kind: str, index: int, parameters: Any) -> Array:
    """Parameters of a feature, as many as it takes."""
    try:
        values = real_array(parameters).ravel()
    except UnreadableNumbers as error:
        raise StandoffError(
            f"The parameter list {error}: {shown(parameters)}", "parameters", parameters
        ) from error
    except (TypeError, ValueError) as error:
        raise StandoffError(
            f"Parameters {shown(parameters)} are not real numbers.", "parameters", parameters
        ) from error
    wanted = COUNT[kind]
    atlas = kind == "face" and charts_of(body, index)[1] > 1
    if len(values) not in (wanted, wanted + atlas) or not np.isfinite(values).all():
        also = " (and the number of its chart)" if atlas else ""
        raise StandoffError(
            f"A {kind} takes {wanted} finite parameters{also}, not {shown(parameters)}.",
            "parameters",
            parameters,
        )
    return values


def _chart_of(body: Body, face: int, values: Array) -> int:
    """The packed chart of parameters (u, v) or (u, v, chart) on a face."""
    first, count = charts_of(body, face)
    u, v = float(values[0]), float(values[1])
    numbers = range(count)
    if len(values) == 3:
        if values[2] not in numbers:
            raise StandoffError(
                f"Face {face} has charts 0 to {count - 1}, not {values[2]}.", "parameters", values
            )
        numbers = range(int(values[2]), int(values[2]) + 1)
    for number in numbers:
        if on_face(body.ints, body.reals, first + number, u, v):
            return first + number
    raise StandoffError(
        f"Parameters {tuple(values)} lie outside face {face}.", "parameters", values
    )
