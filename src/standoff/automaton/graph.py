"""The hybrid automaton of a pair, Eqs. (15)-(17): modes, switching functions, resets.

A mode of the pair is a feature of A with a feature of B. Each switch changes one of the two, so the
pair's automaton is the product of the bodies' own, and these are what is listed. They are read from
the packed bodies, which is what the kernels go by.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from standoff.automaton.transitions import Transition
from standoff.automaton.visits import Course, Visit
from standoff.bodies.boundary import Boundary
from standoff.bodies.features import Feature, feature_of
from standoff.bodies.tessellation import coedges_of
from standoff.kernels.body import layout as L


class Switch(Protocol):
    """A switch of a motion, such as a `RecordedEvent`: time in s, of body "A" or "B"."""

    @property
    def time(self) -> float: ...
    @property
    def body(self) -> str: ...
    @property
    def source(self) -> Feature: ...
    @property
    def target(self) -> Feature: ...


@dataclass(frozen=True, eq=False)
class Automaton(Course):
    """What `automaton` lists, and, once marked, where a motion went.

    Attributes
    ----------
    a, b : Boundary
    features_a, features_b : tuple of Feature
        Smooth edges are among them: they are passed, and held only if a step would cross them back
        and forth.
    transitions : tuple of Transition
        Those of A, then those of B.
    visits : tuple of Visit
        In order of time; empty if no motion is marked. Between two that are not adjacent in time,
        the bodies overlapped.
    taken : tuple of (float, Transition)
        The switches of the motion with their times [s].
    restarts : tuple of float
        Times [s] at which a global start changed the mode in a way that is not a transition.
    """

    a: Boundary
    b: Boundary
    features_a: tuple[Feature, ...]
    features_b: tuple[Feature, ...]
    transitions: tuple[Transition, ...]
    visits: tuple[Visit, ...] = ()
    taken: tuple[tuple[float, Transition], ...] = ()
    restarts: tuple[float, ...] = ()

    @property
    def modes(self) -> int:
        """How many modes the pair has."""
        return len(self.features_a) * len(self.features_b)

    def of(self, body: str) -> tuple[Transition, ...]:
        """The transitions of body "A" or "B"."""
        return tuple(t for t in self.transitions if t.body == body)

    def marked(self, visits: Sequence[Visit], events: Iterable[Switch]) -> Automaton:
        """Return the automaton with a motion marked: a recording's ``modes()`` and ``events``."""
        known = {(t.body, t.source, t.target): t for t in self.transitions}
        taken, restarts = [], []
        for event in events:
            transition = known.get((event.body, event.source, event.target))
            if transition is None:
                restarts.append(event.time)
            else:
                taken.append((event.time, transition))
        return replace(self, visits=tuple(visits), taken=tuple(taken), restarts=tuple(restarts))


def automaton(a: Boundary, b: Boundary) -> Automaton:
    """List the hybrid automaton of a pair of bodies."""
    return Automaton(
        a,
        b,
        features_of(a),
        features_of(b),
        (*body_transitions(a, "A"), *body_transitions(b, "B")),
    )


def features_of(body: Boundary) -> tuple[Feature, ...]:
    """All features of a body: faces, edges, vertices."""
    return tuple(feature_of(body, k) for k in range(body.n_faces + body.n_edges + body.n_vertices))


def is_smooth(body: Boundary, feature: Feature) -> bool:
    """Is the feature an edge along which both faces share their normal?"""
    return feature.kind == "edge" and bool(_edge_row(body, feature.index)[L.EDGE_FLAGS] & L.SMOOTH)


def body_transitions(body: Boundary, name: str) -> list[Transition]:
    """List one body's transitions; `name` is "A" or "B"."""
    slope = "−n·" if name == "A" else "n·"
    return [
        *_off_faces(body, name),
        *_off_edges(body, name, slope),
        *_off_vertices(body, name, slope),
    ]


def _edge_row(body: Boundary, edge: int) -> NDArray[np.int64]:
    start = int(body.ints[L.EDGES]) + L.EDGE_STRIDE * edge
    return body.ints[start : start + L.EDGE_STRIDE]


def _face_of_chart(body: Boundary, chart: int) -> int:
    return int(body.ints[int(body.ints[L.CHARTS]) + L.CHART_STRIDE * chart + L.CHART_FACE])


def _sides(body: Boundary) -> list[tuple[int, int]]:
    """(face, edge) of every coedge, each once; a collapsed side has -1 - vertex for its edge."""
    sides = [(_face_of_chart(body, chart), edge) for _, chart, edge in coedges_of(body)]
    return list(dict.fromkeys(sides))


def _off_faces(body: Boundary, name: str) -> list[Transition]:
    sides = _sides(body)
    faces_of: dict[int, list[int]] = {}
    for face, edge in sides:
        faces_of.setdefault(edge, []).append(face)
    found = []
    for face, edge in sides:
        source = Feature("face", face)
        if edge < 0:
            vertex = Feature("vertex", -1 - edge)
            reached = f"(u, v) reaches the side that has collapsed to {vertex}"
            found.append(Transition(name, source, vertex, "boundary", reached, "no parameters"))
            continue
        target = Feature("edge", edge)
        reached = f"(u, v) reaches the trimming curve of {target}"
        found.append(
            Transition(name, source, target, "boundary", reached, "t := its parameter there")
        )
        if is_smooth(body, target):
            for other in faces_of[edge]:
                if other != face:
                    reset = f"(u, v) := the trimming curve of {target} on face {other} there"
                    across = Feature("face", other)
                    found.append(Transition(name, source, across, "smooth", reached, reset))
    return found


def _off_edges(body: Boundary, name: str, slope: str) -> list[Transition]:
    found = []
    faces_of: dict[int, list[int]] = {}
    for face, edge in _sides(body):
        faces_of.setdefault(edge, []).append(face)
    for edge in range(body.n_edges):
        source = Feature("edge", edge)
        row = _edge_row(body, edge)
        for end in range(2):
            if row[L.EDGE_FIRST + end] >= 0:
                reached = f"t reaches {_end(body, edge, end):.6g}"
                target = Feature("vertex", int(row[L.EDGE_FIRST + end]))
                found.append(Transition(name, source, target, "boundary", reached, "no parameters"))
        for face in faces_of.get(edge, []):
            falls = f"{slope}m < −ε, m the inward conormal of face {face} at t"
            reset = f"(u, v) := the trimming curve of {source} on face {face} at t"
            target = Feature("face", face)
            found.append(Transition(name, source, target, "release", falls, reset))
    return found


def _off_vertices(body: Boundary, name: str, slope: str) -> list[Transition]:
    found = []
    for vertex in range(body.n_vertices):
        source = Feature("vertex", vertex)
        start = int(body.ints[L.VERTICES]) + L.VERTEX_STRIDE * vertex
        row = body.ints[start : start + L.VERTEX_STRIDE]
        fan, sectors = int(row[L.VERTEX_FAN]), int(row[L.VERTEX_SECTORS])
        for k in range(int(row[L.VERTEX_N_FAN])):
            edge, end = (int(value) for value in body.ints[fan + 2 * k : fan + 2 * k + 2])
            falls = f"{slope}τ < −ε, τ the unit tangent into edge {edge}"
            reset = f"t := {_end(body, edge, end):.6g}"
            found.append(Transition(name, source, Feature("edge", edge), "release", falls, reset))
        for k in range(int(row[L.VERTEX_N_SECTORS])):
            chart, offset = (
                int(value) for value in body.ints[sectors + 2 * k : sectors + 2 * k + 2]
            )
            face = Feature("face", _face_of_chart(body, chart))
            falls = f"least {slope}c < −ε among the unit directions c into {face}"
            apex = int(body.reals[offset]) == L.SECTOR_APEX
            reset = "(u, v) := the side that has collapsed, at the steepest direction"
            if not apex:
                reset = f"(u, v) := ({body.reals[offset + 1]:.6g}, {body.reals[offset + 2]:.6g})"
            found.append(Transition(name, source, face, "release", falls, reset))
    return found


def _end(body: Boundary, edge: int, end: int) -> float:
    """The parameter of an edge's first (0) or last (1) end."""
    offset = int(_edge_row(body, edge)[L.EDGE_REALS])
    return float(body.reals[offset + L.EDGE_T0 + end])
