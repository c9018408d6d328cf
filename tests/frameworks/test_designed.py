"""Derivatives by design parameters and poses, on NumPy's side: beside `shape_gradient`,
differences, and the derivatives by poses alone."""

from __future__ import annotations

import numpy as np
import pytest

import standoff as so
from frameworks.cases import LOST, STACKED, close
from frameworks.designs import BOX, EGG, LENS, PARAMETERS, POSES, answer_of, differences, told
from standoff.errors import DerivativeWarning, StandoffError
from standoff.frameworks import ambient, designed

BOTH = designed.Designs.of(LENS, EGG, PARAMETERS, "nan")


def arrays(params: tuple[dict, dict] = PARAMETERS, where: str = "apart") -> list[np.ndarray]:
    """In the order of the labels."""
    return [np.asarray(x) for x in BOTH.arrays(params, POSES[where])]


@pytest.mark.parametrize("where", POSES)
def test_gradients_are_those_of_the_shape_and_of_the_poses(where: str) -> None:
    found = designed.first(BOTH, *arrays(where=where))
    answer, a, b = answer_of(where)
    assert (answer.distance < 0.0) == (where == "overlap")
    close(found.distance, np.array(answer.distance), 0.0)
    rates = told(where)
    assert BOTH.labels[:3] == ["params_a['offset']", "params_a['radius']", "params_b['semi_axes']"]
    by = [found.gradients[1], found.gradients[0], found.gradients[2]]
    exact = [rates.a["radius"], rates.a["offset"], rates.b["semi_axes"]]
    for part, rate in zip(by, exact, strict=True):
        close(part, np.array(rate), 0.0)
    for part, rate in zip(by, differences(where), strict=True):
        close(part, rate, 1e-9)
    poses = ambient.first(ambient.AmbientPair(a.body, b.body, "nan"), *POSES[where]).gradient
    close(np.array(found.gradients[3:]), poses, 0.0)


def test_rows_of_several_sets_are_the_single_ones(rng: np.random.Generator) -> None:
    """Sets that come again, in any order; one pose of A for all, and a parameter for all."""
    radii = np.array([1.0, 1.1, 1.0, 1.2, 1.1, 1.0])
    poses = np.array([POSES["apart"][1]] * 6)
    poses[:, :3, 3] += 0.1 * rng.normal(size=(6, 3))
    given = [np.array(0.42), radii, np.array([0.5, 0.3, 0.4]), POSES["apart"][0], poses]
    found = designed.first(BOTH, *given)
    close(designed.value(BOTH, *given), found.distance, 0.0)
    for k in range(6):
        one = designed.first(BOTH, given[0], radii[k], *given[2:4], poses[k])
        close(found.distance[k], one.distance, 1e-14)
        for many, alone in zip(found.gradients, one.gradients, strict=True):
            close(many[k], alone, 1e-11)
    still = designed.first(BOTH, np.array(0.42), radii, given[2], *POSES["apart"])
    for k in (1, 3):
        one = designed.first(BOTH, given[0], radii[k], given[2], *POSES["apart"])
        for many, alone in zip(still.gradients, one.gradients, strict=True):
            close(many[k], alone, 1e-11)


def test_parameters_that_are_left_out_are_not_differentiated() -> None:
    made = []

    def egg(semi_axes: np.ndarray, more: np.ndarray) -> so.Body:
        made.append(more)
        return so.shapes.ellipsoid(semi_axes)

    design = so.Design(egg, semi_axes=[0.5, 0.3, 0.4], more=np.zeros(100))
    designs = designed.Designs.of(design, EGG.body, ({"semi_axes": 0}, {}), "nan")
    close(
        designed.first(designs, np.array([0.5, 0.3, 0.4]), *POSES["apart"]).gradients[0],
        np.array(so.shape_gradient(
            so.distance(EGG.body, EGG.body, *POSES["apart"]), a=EGG
        ).a["semi_axes"]),
        1e-12,
    )  # fmt: skip
    assert len(made) == 13  # the body, and four beside it of each of three numbers
    designed.value(designs, np.array([0.5, 0.3, 0.4]), *POSES["apart"])
    assert len(made) == 13


def test_undefined_derivatives_are_nan_with_a_warning_or_an_error() -> None:
    given = np.ones(3), np.eye(4), STACKED
    designs = designed.Designs.of(BOX, BOX.body, ({"size": None}, {}), "nan")
    with pytest.warns(DerivativeWarning, match="does not have all derivatives"):
        found = designed.first(designs, *given)
    assert np.isnan(found.gradients[0]).all()
    np.testing.assert_array_equal(np.isnan(found.gradients[2]), LOST)
    close(found.distance, np.array(0.5), 1e-12)
    with pytest.warns(DerivativeWarning, match="has no derivatives"):
        assert np.isnan(
            designed.first(designs, np.ones(3), np.eye(4), np.eye(4)).gradients[0]
        ).all()
    strict = designs._replace(undefined="raise")
    close(designed.value(strict, *given), np.array(0.5), 1e-12)
    with pytest.raises(StandoffError, match="does not have all derivatives"):
        designed.first(strict, *given)
    tilted = STACKED @ so.Pose.exp([0.3, 0.2, 0.1], [0, 0, 1.0]).matrix
    sizes = np.array([[1.0, 1.0, 1.0], [1.0, 1.1, 1.0], [1.0, 1.0, 1.0], [1.0, 1.1, 1.0]])
    with pytest.warns(DerivativeWarning, match=r"of row 1 .*\(2 of 4 rows.\)"):
        rows = designed.first(designs, sizes, np.eye(4), np.array([tilted, STACKED] * 2))
    np.testing.assert_array_equal(np.isnan(rows.gradients[0]).all(axis=1), [False, True] * 2)
    with pytest.warns(DerivativeWarning, match=r"\(3 of 3 rows.\)"):
        designed.first(designs, sizes[:1] * np.ones((3, 1)), np.eye(4), STACKED)


def test_what_cannot_serve_is_refused() -> None:
    of = designed.Designs.of
    with pytest.raises(TypeError, match=r"design_b = 3: give a so\.Design"):
        of(LENS, 3, ({}, {}), "nan")
    with pytest.raises(StandoffError, match="a body has no parameters"):
        of(LENS.body, EGG, ({"radius": 1.0}, {}), "nan")
    with pytest.raises(TypeError, match="params_b = 3: give a dict"):
        of(LENS, EGG, ({}, 3), "nan")
    with pytest.raises(StandoffError, match=r"params_a = 'radios'.*Did you mean 'radius'\?"):
        of(LENS, EGG, ({"radios": 1.0}, {}), "nan")
    with pytest.raises(StandoffError, match="undefined = 'zero'"):
        of(LENS, EGG, ({}, {}), "zero")
    wrong = arrays()
    wrong[2] = np.ones(2)
    with pytest.raises(StandoffError, match=r"params_b\['semi_axes'\] has the shape \(2,\): give"):
        designed.value(BOTH, *wrong)
    wrong[2], wrong[0], wrong[1] = np.ones(3), np.ones(2), np.ones(3)
    with pytest.raises(StandoffError, match=r"numbers of rows differ: params_a\['offset'\] 2"):
        designed.value(BOTH, *wrong)
    for numbers in (-1.0, np.nan):
        wrong = arrays(({"radius": numbers, "offset": 0.4}, PARAMETERS[1]))
        with pytest.raises(StandoffError, match=r"params_a make no body: with offset = 0\.4"):
            designed.value(BOTH, *wrong)
    wrong = arrays(({"radius": np.array([1.0, 1.1, 1.0]), "offset": 0.4}, PARAMETERS[1]))
    wrong[-1] = np.array([POSES["apart"][1], POSES["apart"][1], 2 * np.eye(4)])
    with pytest.raises(StandoffError, match=r"Of the rows \[0, 2\].*Row 1 of poses_b"):
        designed.value(BOTH, *wrong)
    solid = so.Design(lambda r: so.Solid(so.shapes.sphere(r)), r=1.0)
    with pytest.raises(TypeError, match="give a design of a Body"):
        designed.value(of(solid, LENS.body, ({}, {}), "nan"), *POSES["apart"])


def test_only_some_parameters_of_a_design() -> None:
    thick = LENS.changed(radius=1.2).only("offset")
    assert thick.parameters == {"offset": 0.45}
    answer = so.distance(thick.changed(offset=0.4).body, EGG.body, *POSES["apart"])
    whole = so.distance(LENS.changed(radius=1.2, offset=0.4).body, EGG.body, *POSES["apart"])
    assert answer.distance == whole.distance
    with pytest.raises(StandoffError, match=r"names = 'ofset'.*Did you mean 'offset'"):
        LENS.only("ofset")
    with pytest.raises(StandoffError, match="no parameter"):
        LENS.only()
