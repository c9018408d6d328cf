"""The errors' tree, and what their fields name."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import standoff as so
from standoff import geometry, motion
from standoff.errors import (
    BodyError,
    FormulaError,
    MaskedNumbers,
    StandoffError,
    StandoffTypeError,
    UnreadableNumbers,
    VoronoiError,
)
from standoff.scene import load_scene
from standoff.scene.errors import SceneError

NET = [[[0.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [[1.0, 0.0, 0.0], [1.0, 1.0, 0.5]]]
BAD_WEIGHTS = [[1.0, 1.0], [1.0, -1.0]]
CORNERS = np.eye(3)
LOOSE = so.bodies.Edge(geometry.Line(CORNERS[0], CORNERS[1]), 0, 7)

REFUSED: list[tuple[Callable[[], Any], type[StandoffError], str, Any]] = [
    (lambda: geometry.BezierPatch(NET, BAD_WEIGHTS), StandoffError, "weights", BAD_WEIGHTS),
    (lambda: geometry.Line([0, 0, 0], [np.nan, 0, 0]), StandoffError, "q", None),
    (lambda: geometry.Torus(-1.0, 1.0), StandoffError, "major", -1.0),
    (
        lambda: geometry.FormulaSurface("cos(w)", "u", "v", (0, 1, 0, 1)),
        FormulaError,
        "x",
        "cos(w)",
    ),
    (
        lambda: geometry.FormulaSurface("u*v", "u", "v", (1, 0, 0, 1)),
        FormulaError,
        "domain",
        (1, 0, 0, 1),
    ),
    (lambda: motion.Twist([0, 0, np.inf], [0, 0, 0]), StandoffError, "v", None),
    (lambda: so.Body.from_patches(3), BodyError, "patches", 3),
    (lambda: so.shapes.sphere(1.0).transformed(np.zeros((3, 3))), StandoffError, "affine", None),
    (lambda: so.distance("A", "B", np.eye(4), np.eye(4)), StandoffTypeError, "body", "A"),
    (
        lambda: so.voronoi_regions(so.shapes.sphere(1.0), reach=-2.0),
        StandoffError,
        "reach",
        -2.0,
    ),
]


@pytest.mark.parametrize(("call", "kind", "argument", "value"), REFUSED)
def test_an_error_names_the_argument_and_what_was_given(
    call: Callable[[], Any], kind: type[StandoffError], argument: str, value: Any
) -> None:
    with pytest.raises(kind) as caught:
        call()
    assert type(caught.value) is kind
    assert caught.value.argument == argument
    if value is not None:
        assert caught.value.value is value or caught.value.value == value


def test_an_error_about_a_body_names_the_part() -> None:
    with pytest.raises(BodyError) as caught:
        so.Body.from_brep(CORNERS, [LOOSE], [])
    assert caught.value.part == ("edge", 0)
    with pytest.raises(BodyError) as caught:
        so.Body.from_patches([3])
    assert caught.value.part == ("patch", 0)


def test_a_scene_names_the_key_at_fault_by_the_error_and_not_by_its_words(tmp_path: Path) -> None:
    """The message begins with "FormulaSurface.domain", which is not a key."""
    scene = tmp_path / "scene.toml"
    patch = '{kind = "formula", x = "u", y = "v", z = "u*v", domain = [1.0, 0.0, 0.0, 1.0]}'
    scene.write_text(f'version = 1\n[bodies.a]\nshape = "patches"\npatches = [{patch}]\n')
    with pytest.raises(SceneError) as caught:
        load_scene(scene)
    assert caught.value.key == caught.value.argument == "bodies.a.patches[0].domain"
    assert caught.value.value == [1.0, 0.0, 0.0, 1.0]


def test_every_error_is_a_value_error_and_what_it_was_before() -> None:
    assert so.StandoffError is StandoffError
    for kind in (BodyError, FormulaError, MaskedNumbers, SceneError, StandoffTypeError):
        assert issubclass(kind, StandoffError)
    assert issubclass(StandoffError, ValueError)
    assert issubclass(MaskedNumbers, UnreadableNumbers)
    assert issubclass(UnreadableNumbers, StandoffTypeError)
    assert issubclass(StandoffTypeError, TypeError)
    assert issubclass(VoronoiError, StandoffError)
    assert issubclass(VoronoiError, RuntimeError)


def test_an_error_keeps_its_fields_through_a_pickle() -> None:
    scene = SceneError("too long", key="pair.a", file=Path("s.toml"), value=3)
    for error in (BodyError("no", "patches", [1], part=("edge", 2)), scene):
        again = pickle.loads(pickle.dumps(error))
        assert type(again) is type(error)
        assert vars(again) == vars(error)
        assert str(again) == str(error)
