"""The automaton of a pair: what it lists, that motions go along it, and how it is written."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread

import standoff as so
from standoff.automaton.graph import Automaton, automaton, body_transitions
from standoff.automaton.picture import write_automaton
from standoff.automaton.text import (
    automaton_mermaid,
    automaton_text,
    moves,
    product_switches,
)
from standoff.bodies.shapes import sphere_atlas
from standoff.geometry import ConicArc
from standoff.motion import ConstantTwist, Fixed

BOX = so.shapes.box(1.0, 0.8, 0.6)
LENS = so.shapes.lens(1.0, 0.45)
CONE = so.shapes.cone(0.5, 1.0)
CAPSULE = so.shapes.capsule(0.2, 1.0)

# body, faces + edges + vertices, transitions by kind
COUNTS = [
    # Every edge of a polyhedron bounds two faces and has two ends; each of these four is entered
    # and left: 4 · 12 for the faces' boundaries and the edges' ends, 4 · 12 back.
    (BOX, 26, {"boundary": 48, "release": 48}),
    (LENS, 8, {"boundary": 12, "release": 12}),
    # The side ends at the apex and at the rim, the base at the rim.
    (CONE, 4, {"boundary": 3, "release": 3}),
    (CAPSULE, 3, {"boundary": 2, "release": 2}),
    (so.shapes.ellipsoid(0.3, 0.2, 0.1), 1, {}),
    (so.shapes.cylinder(0.2, 0.5), 5, {"boundary": 4, "release": 4}),
    (so.shapes.halfspace(), 1, {}),
]


@pytest.mark.parametrize(("body", "features", "kinds"), COUNTS, ids=lambda value: str(value)[:20])
def test_counts(body: so.Body, features: int, kinds: dict[str, int]) -> None:
    transitions = body_transitions(body, "A")
    assert Counter(t.kind for t in transitions) == kinds
    assert len(set(transitions)) == len(transitions)
    other = automaton(body, LENS)
    assert other.modes == 8 * features
    assert other.of("A") == tuple(transitions)


def test_what_is_entered_can_be_left() -> None:
    for body, _, _ in COUNTS:
        ways = {(t.source, t.target) for t in body_transitions(body, "B")}
        assert {(target, source) for source, target in ways} == ways


def test_switching_functions_and_resets_say_where() -> None:
    found = {(t.source, t.target): t for t in body_transitions(CAPSULE, "A")}
    edge, low = so.Feature("edge", 0), so.Feature("vertex", 0)
    assert found[edge, low].switching == "t reaches 0"
    assert found[low, edge].switching.startswith("−n·τ < −ε")
    assert found[low, edge].reset == "t := 0"
    # On B the unit vector from A to B leads inwards.
    assert body_transitions(CAPSULE, "B")[2].switching.startswith("n·τ < −ε")
    apex = [t for t in body_transitions(CONE, "A") if t.target == so.Feature("vertex", 0)]
    assert ["collapsed" in t.switching for t in apex] == [True]


def tumbling(a: so.Body, b: so.Body) -> so.Recording:
    path = ConstantTwist(so.Pose(np.eye(3), (1.6, 0.1, 0.2)), ((0.0, 0.0, 0.0), (3.0, 2.0, 1.0)))
    return so.track(so.Tracker(a, b, 0.01), path, Fixed(np.eye(4)), 3.0)


@pytest.fixture(scope="module")
def recording() -> so.Recording:
    """A box that tumbles beside a lens."""
    return tumbling(BOX, LENS)


@pytest.fixture(scope="module")
def marked(recording: so.Recording) -> Automaton:
    return automaton(BOX, LENS).marked(recording.modes(), recording.events)


def test_a_motion_goes_along_the_transitions(recording: so.Recording, marked: Automaton) -> None:
    assert len(recording.events) >= 10
    assert len(marked.taken) + len(marked.restarts) == len(recording.events)
    assert not marked.restarts
    for (time, transition), event in zip(marked.taken, recording.events, strict=True):
        assert time == event.time
        assert (transition.source, transition.target) == (event.source, event.target)
    seen = set(zip(recording.feature_a, recording.feature_b, strict=True))
    assert set(marked.visited) >= seen
    assert sum(map(marked.time_in, marked.visited)) == pytest.approx(3.0, abs=1e-12)
    ways = set(product_switches(marked))
    assert sum(len(times) for _, _, times in moves(marked.visits)) == len(marked.visits) - 1
    # Two switches at one instant leave the mode between them unvisited.
    assert sum((a, b) in ways for a, b, _ in moves(marked.visits)) >= 0.8 * len(marked.visited)


def test_a_change_that_is_no_transition_is_a_restart(recording: so.Recording) -> None:
    event = recording.events[0]._replace(source=so.Feature("face", 0), target=so.Feature("face", 5))
    again = automaton(BOX, LENS).marked(recording.modes(), [event])
    assert again.restarts == (event.time,)
    assert again.taken == ()
    assert ", 1 restart\n" in automaton_text(again)


def test_smooth_edges_are_passed() -> None:
    # A ball of two halves: smooth along the cut.
    half = np.eye(3)
    rim = so.bodies.Edge(ConicArc((0, 0, 0), (1, 0, 0), (0, 1, 0)))
    body = so.Body.from_brep(
        edges=[rim],
        faces=[
            so.bodies.Face(sphere_atlas(half, np.zeros(3)), ((0, 1),)),
            so.bodies.Face(sphere_atlas(np.diag([1.0, -1.0, -1.0]), np.zeros(3)), ((0, -1),)),
        ],
    )
    found = body_transitions(body, "A")
    across = [(str(t.source), str(t.target)) for t in found if t.kind == "smooth"]
    assert across == [("face 0", "face 1"), ("face 1", "face 0")]
    assert "smooth: passed from face to face" in automaton_text(automaton(body, LENS))


def test_text_lists_everything(marked: Automaton) -> None:
    text = automaton_text(marked, ("crate", "lens"))
    assert "modes: 26 features of A × 8 of B = 208" in text
    assert "A = crate (box): 6 faces, 12 edges, 8 vertices, 96 switches" in text
    assert text.count(" → ") == 96 + 24 + len({t for _, t in marked.taken})
    assert f"{len(marked.visited)} of 208 modes, {len(marked.taken)} switches" in text
    for a, b in marked.visited:
        assert f"  {a} – {b} " in text
    assert "visited" not in automaton_text(automaton(BOX, LENS))


def test_mermaid_names_each_node_before_its_arrows(marked: Automaton) -> None:
    for drawn in (marked, automaton(CAPSULE, CONE), automaton(BOX, BOX)):
        lines = automaton_mermaid(drawn, ('the "crate"', "lens")).splitlines()
        assert lines[0] == "flowchart LR"
        assert sum(line.strip().startswith("subgraph") for line in lines) == sum(
            line.strip() == "end" for line in lines
        )
        assert "A = the 'crate'" in lines[1]
        known: set[str] = set()
        for line in (line.strip() for line in lines):
            words = line.split()
            if line.startswith(("A_", "B_", "m_")) and len(words) > 2 and words[1][:1] in "-=<":
                assert {words[0], words[-1]} <= known
            elif line.startswith(("A_", "B_", "m_")):
                known.add(line[: min(line.index(c) for c in "[(" if c in line)])
    assert "12 modes" not in automaton_mermaid(automaton(CAPSULE, CONE))
    assert "the product has 676 modes" in automaton_mermaid(automaton(BOX, BOX))


@pytest.mark.parametrize("ending", ["svg", "png"])
def test_pictures(tmp_path: Path, marked: Automaton, ending: str) -> None:
    for k, drawn in enumerate((marked, automaton(CAPSULE, CONE), automaton(LENS, CAPSULE))):
        target = tmp_path / f"{k}.{ending}"
        with target.open("wb") as file:
            write_automaton(file, ending, drawn, ("crate", "lens"))
        if ending == "png":
            assert imread(target).std() > 0.02
            continue
        text = target.read_text()
        for feature in (*drawn.features_a, *drawn.features_b):
            short = f"{feature.kind[0]}{feature.index}"
            assert f"<!-- {feature} -->" in text or short in text
