"""The adaptive rule: what it integrates exactly, and that its remainder bounds its error.

As cells of a boundary have them, integrands are analytic inside, up to powers at a cell's border.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

import standoff as so
from standoff.bodies.moments.cells import BATCH_NODES, MomentCell, evaluated, integrate, rule
from standoff.bodies.moments.face_cells import face_cells
from standoff.bodies.moments.flux import COLUMNS, IntegralFrame

Array = NDArray[np.float64]
Plain = Callable[[Array, Array], Array]


def cell(
    f: Plain, low: tuple[float, float] = (0, 0), high: tuple[float, float] = (1, 1)
) -> MomentCell:
    return MomentCell(lambda _, t, s: f(t[:, :, None], s[:, None, :])[..., None], low, high)


@pytest.mark.parametrize("level", [3, 4, 5, 6])
def test_a_rule_of_n_nodes_is_exact_to_degree_n(level: int) -> None:
    nodes, weights = rule(level)
    assert (weights[0] > 0.0).all()
    for degree in range(2**level):
        assert weights[0] @ nodes**degree == pytest.approx(1 / (degree + 1), abs=1e-14)


def test_coarse_rules_stand_on_the_nodes_of_the_fine_one() -> None:
    nodes, weights = rule(5)
    for k, level in ((1, 4), (2, 3)):
        own, own_weights = rule(level)
        used = weights[k] != 0.0
        np.testing.assert_allclose(nodes[used], own, atol=1e-15)
        np.testing.assert_allclose(weights[k][used], own_weights[0], atol=1e-15)


def test_what_needs_nodes_along_one_parameter_is_seen_along_it() -> None:
    sums = evaluated([cell(lambda t, s: np.cos(30 * t) + 0 * s)])
    assert sums.first[0, 0] > 1e-3
    assert sums.second[0, 0] < 1e-15


def test_cells_evaluated_together_are_those_evaluated_alone() -> None:
    """Of several functions and rules, in any order, more than a batch holds."""
    body = so.shapes.cylinder(1.0, 2.0)
    frame = IntegralFrame(np.array([0.1, 0.0, 0.2]), 3.0, 0.2)
    strips = [part for k in range(body.n_faces) for part in face_cells(body, k, frame)]
    other = MomentCell(
        lambda _, t, s: np.cos(np.arange(COLUMNS) * t[:, :, None, None] * s[:, None, :, None])
    )
    cells = [
        replace(part, levels=(4 + k % 2, 3 + k % 3), high=(part.high[0], 1.0 - 0.01 * k))
        for k, part in enumerate([*strips, other, *strips] * 9)
    ]
    assert len({part.piece.chart.number for part in strips}) == 3
    assert sum(part.nodes for part in cells) > 6 * BATCH_NODES
    together = evaluated(cells)
    for k, part in enumerate(cells):
        alone = evaluated([part])
        for name in ("values", "first", "second", "magnitude"):
            one, by_itself = getattr(together, name)[k], getattr(alone, name)[0]
            np.testing.assert_allclose(one, by_itself, 1e-12, 1e-14, err_msg=f"{k} {name}")


HARD: dict[str, tuple[Plain, float]] = {
    "smooth": (lambda t, s: np.exp(t + 2 * s), (np.e - 1) * (np.e**2 - 1) / 2),
    "root": (lambda t, s: np.sqrt(t) * s, 1 / 3),
    "power": (lambda t, s: t**-0.3 * np.cos(s), np.sin(1.0) / 0.7),
    "peak": (
        lambda t, s: 1 / ((t - 0.3) ** 2 + 1e-4) + 0 * s,
        100 * (np.arctan(70.0) + np.arctan(30.0)),
    ),
    "corner": (lambda t, s: np.hypot(t, s), (np.sqrt(2) + np.arcsinh(1.0)) / 3),
    "wave": (lambda t, s: np.sin(40 * t * s), 0.0),
}


def reference(name: str) -> float:
    if name != "wave":
        return HARD[name][1]
    nodes, weights = np.polynomial.legendre.leggauss(200)
    x, w = 0.5 * (nodes + 1), 0.5 * weights
    return float(w @ np.sin(40 * np.outer(x, x)) @ w)


@pytest.mark.parametrize("name", HARD)
@pytest.mark.parametrize("most", [100, 3000, 100_000])
def test_the_remainder_bounds_the_error_wherever_it_ends(name: str, most: int) -> None:
    f = HARD[name][0]
    total = integrate([cell(f)], np.ones_like, 1e-10, most)
    rounding = 1e-14 * total.magnitude[0]
    assert abs(total.values[0] - reference(name)) <= total.remainder[0] + rounding
    if most == 100_000 and name != "power":
        assert total.remainder[0] <= 2e-10


def test_halves_cover_a_cell_once() -> None:
    f: Plain = lambda t, s: 1 / ((t - 0.37) ** 2 + 1e-3) + 1 / ((s - 0.61) ** 2 + 1e-3)  # noqa: E731
    total = integrate([cell(f, (-1, 0), (1, 2))], np.ones_like, 1e-9, 200_000)
    width = np.sqrt(1e-3)
    along = 2 * (np.arctan(0.63 / width) + np.arctan(1.37 / width)) / width
    across = 2 * (np.arctan(0.61 / width) + np.arctan(1.39 / width)) / width
    assert total.values[0] == pytest.approx(along + across, rel=1e-11)
    assert total.nodes > 5000


def test_columns_without_a_size_are_not_refined_for() -> None:
    wild = MomentCell(
        lambda _, t, s: np.stack(
            [np.ones((1, t.size, s.size)), np.cos(900 * np.add.outer(t[0], s[0]))[None]], axis=-1
        )
    )
    total = integrate([wild], lambda values: np.array([1.0, np.inf]), 1e-12, 100_000)
    assert total.nodes == 49
