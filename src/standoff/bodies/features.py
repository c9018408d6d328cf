"""Names of a body's features."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from standoff.bodies.boundary import Boundary
from standoff.kernels.body import layout as L


@dataclass(frozen=True, order=True)
class Feature:
    """A face, edge or vertex of a body, numbered within its kind.

    Attributes
    ----------
    kind : str
        "face", "edge" or "vertex"; empty for no feature.
    index : int
        From 0; -1 for no feature.
    """

    kind: str
    index: int

    def __iter__(self) -> Iterator[str | int]:
        return iter((self.kind, self.index))

    def __str__(self) -> str:
        return f"{self.kind} {self.index}" if self.kind else ""


NO_FEATURE = Feature("", -1)
"""Of a pair beyond its horizon, which has no witness points."""


def feature_told(text: str) -> Feature:
    """The feature that `str` made a text of.

    Raises ValueError: it made no such text.
    """
    if not text.strip():
        return NO_FEATURE
    kind, index = text.split()
    return Feature(kind, int(index))


def feature_of(body: Boundary, number: int) -> Feature:
    """The feature of a packed number: faces first, then edges, then vertices; of a negative one,
    which stands for none, an empty kind and -1."""
    if number < 0:
        return NO_FEATURE
    if number < body.n_faces:
        return Feature("face", number)
    number -= body.n_faces
    if number < body.n_edges:
        return Feature("edge", number)
    return Feature("vertex", number - body.n_edges)


def charts_of(body: Boundary, face: int) -> tuple[int, int]:
    """(first packed chart, number of charts) of a face."""
    row = int(body.ints[L.FACES]) + L.FACE_STRIDE * face
    return int(body.ints[row]), int(body.ints[row + 1])
