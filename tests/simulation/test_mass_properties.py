"""Mass, centre and inertia against formulas, their bounds, and what is refused."""

from __future__ import annotations

import pickle
from collections.abc import Callable

import numpy as np
import pytest
from mass_cases import CASES, CLOUD, TETRAHEDRON, rounded_cylinder

import solids
import standoff as so
from solids import Solid
from standoff.bodies.moments import boundary
from standoff.bodies.moments.cells import MomentCell
from standoff.bodies.moments.flux import IntegralFrame
from standoff.geometry import (
    BezierPatch,
    ConicArc,
    Pcurve,
    Plane,
    SuperellipsoidPole,
    SuperellipsoidSide,
    SurfaceCurve,
)
from standoff.simulation import MassErrors, MassProperties, mass_properties

SHAPES = so.shapes


def rounded_triangle(r: float) -> so.Body:
    return SHAPES.polygon([[-1, 0, 0], [1, 0, 0], [0, 0, 1]], rounding=r)


SUPERELLIPSOIDS = ((1.0, 1.0), (0.5, 0.5), (0.9, 0.3), (1.7, 1.7), (0.6, 1.3))


def judged(found: MassProperties, true: Solid, share: float) -> None:
    """Within its bounds, and these within a share of the size."""
    size = true.volume ** (1 / 3)
    assert found.volume is not None
    # what the formula itself is known to
    rounding = 1e-14 * (1 + float(np.abs(true.centre).max()) / size)
    assert abs(found.volume - true.volume) <= found.error.volume + rounding * true.volume
    off = float(np.linalg.norm(found.centre - true.centre))
    assert off <= found.error.centre + rounding * size
    miss = float(np.linalg.norm(found.inertia - found.mass / found.volume * true.inertia, 2))
    assert miss <= found.error.inertia + rounding * float(np.trace(found.inertia))
    assert found.error.volume <= share * true.volume
    assert found.error.inertia <= 100 * share * float(np.trace(found.inertia))
    assert found.error.centre <= share * size * 100


@pytest.mark.parametrize("name", CASES)
def test_a_closed_form_is_met(name: str) -> None:
    body, true = CASES[name]
    found = mass_properties(body(), density=2.0)
    judged(found, true(), 1e-9 if name != "plate" else 1e-6)
    assert found.mass == 2.0 * found.volume
    assert found.error.mass == 2.0 * found.error.volume


@pytest.mark.parametrize("exponents", SUPERELLIPSOIDS)
def test_superellipsoids_have_the_moments_of_beta_functions(exponents: tuple[float, float]) -> None:
    body = SHAPES.superellipsoid(1.0, 2.0, 1.5, *exponents)
    found = mass_properties(body, tolerance=1e-6)
    judged(found, solids.superellipsoid(1.0, 2.0, 1.5, *exponents), 1e-5)


@pytest.mark.parametrize("tolerance", [0.1, 1e-3, 1e-6])
@pytest.mark.parametrize(
    "name", ["ellipsoid", "thin ellipsoid", "rounded cone", "large cap", "lens", "egg", "ring"]
)
def test_the_bound_holds_however_early_refinement_ends(name: str, tolerance: float) -> None:
    body, true = CASES[name]
    judged(mass_properties(body(), tolerance=tolerance), true(), np.inf)


def test_a_body_is_not_said_to_have_no_volume_for_want_of_nodes() -> None:
    body = SHAPES.cylinder(3.0, 0.1, rounding=0.1)
    coarse = boundary.moments_of(body, 100.0)
    assert coarse.volume_error > 0.25 * coarse.volume
    judged(mass_properties(body, tolerance=100.0), rounded_cylinder(3.0, 0.1, 0.1), np.inf)


def test_a_flat_body_with_a_radius_has_the_volume_of_steiner() -> None:
    r = 0.1
    found = mass_properties(rounded_triangle(r))
    perimeter = 2 + 2 * np.sqrt(2)
    volume = 1.0 * 2 * r + np.pi * r * r / 2 * perimeter + 4 / 3 * np.pi * r**3
    assert found.volume == pytest.approx(volume, rel=1e-13)
    assert found.centre[1] == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize(
    "make",
    [
        lambda r: SHAPES.lens(2, 1, rounding=r),
        lambda r: SHAPES.gore(0.4, 2, rounding=r),
        lambda r: SHAPES.egg(1, 2, 0.4, rounding=r),
        lambda r: SHAPES.polytope(TETRAHEDRON, rounding=r),
        lambda r: SHAPES.cap(1, -0.5, rounding=r),
        lambda r: SHAPES.polygon([[-1, 0, 0], [1, 0, 0], [0, 0, 1]], rounding=0.05 + r),
    ],
    ids=["lens", "gore", "egg", "tetrahedron", "cap", "triangle"],
)
def test_volumes_of_offsets_are_steiners_polynomial(make: Callable[[float], so.Body]) -> None:
    """V(r) is a cubic with 4 pi / 3 before r³: every normal is there once."""
    radii = np.array([0.1, 0.2, 0.3, 0.4])
    found = [mass_properties(make(r)) for r in radii]
    volumes = np.array([float(p.volume or 0.0) for p in found])
    error = max(p.error.volume for p in found)
    cubic = np.linalg.solve(np.vander(radii, 4), volumes)[0]
    assert cubic == pytest.approx(4 / 3 * np.pi, abs=8 * error / (6 * 0.1**3))


def test_the_inertia_of_a_mirrored_body_is_mirrored() -> None:
    mirror = np.diag([1.0, -1.0, 1.0])
    for body in (SHAPES.egg(1, 2, 0.4), SHAPES.lens(2, 1), SHAPES.polytope(CLOUD)):
        one, other = mass_properties(body), mass_properties(body.transformed(mirror))
        assert other.volume == pytest.approx(one.volume, rel=1e-12)
        np.testing.assert_allclose(other.centre, mirror @ one.centre, atol=1e-11)
        np.testing.assert_allclose(other.inertia, mirror @ one.inertia @ mirror, atol=1e-10)


def test_a_gap_that_was_sewn_is_in_the_bound() -> None:
    gap = 1e-5
    corners = np.array([[x, y, z] for x in (0.0, 1) for y in (0.0, 1) for z in (0.0, 1)])
    corners = corners.reshape(2, 2, 2, 3)
    nets = [np.take(corners, end, axis=axis).copy() for axis in range(3) for end in (0, 1)]
    nets[5] += [0.0, 0.0, gap]
    body = so.Body.from_patches(
        [BezierPatch(net) for net in nets], tolerance=3 * gap, convexity_tolerance=1e-3
    )
    assert body.check().sewing_residual >= 0.4 * gap
    found = mass_properties(body)
    assert found.error.volume >= gap
    assert abs(float(found.volume or 0.0) - 1.0) <= found.error.volume


@pytest.mark.parametrize("counted", [0, 2])
def test_a_face_that_is_missed_or_counted_twice_shows_in_the_bound(
    counted: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The integrals that close the boundary find it, whatever the volume says."""
    whole = boundary.face_cells

    def wrong(body: so.Body, face: int, frame: IntegralFrame) -> list[MomentCell]:
        return whole(body, face, frame) * (counted if face == 0 else 1)

    monkeypatch.setattr(boundary, "face_cells", wrong)
    for body, true in ((SHAPES.box(1, 2, 3), 6.0), (SHAPES.cone(1, 2), 2 / 3 * np.pi)):
        found = boundary.moments_of(body, 1e-9)
        assert abs(found.volume - true) > 0.1
        assert found.volume_error > abs(found.volume - true)


def cut_superellipsoid() -> so.Body:
    """The part z <= 0.9 of a ball in the six charts of a superellipsoid."""
    charts = [
        kind(sign * np.eye(3)[:, order], np.zeros(3))
        for sign in (1, -1)
        for kind, order in zip(
            (SuperellipsoidPole, SuperellipsoidSide, SuperellipsoidSide),
            ([0, 1, 2], [1, 2, 0], [0, 2, 1]),
            strict=True,
        )
    ]
    rim = float(np.sqrt(1 - 0.9**2))
    circle = ConicArc([0, 0, 0.9], [rim, 0, 0], [0, rim, 0])
    seen = [(c, Pcurve(circle.kind, np.linalg.inv(c.linear) @ circle.basis())) for c in charts]
    edges = [
        so.bodies.Edge(SurfaceCurve(*seen[0], k * np.pi, (k + 1) * np.pi, seen[1:]), k, 1 - k)
        for k in (0, 1)
    ]
    lid = Plane.through(np.array([0, 0, 0.9]), np.array([1.0, 0, 0]), np.array([0, 1.0, 0]))
    faces = [
        so.bodies.Face(tuple(charts), ((0, -1), (1, -1))),
        so.bodies.Face((lid,), ((0, 1), (1, 1)), (), (so.geometry.pcurve_of(circle, lid),) * 2),
    ]
    return so.Body.from_brep([[rim, 0, 0.9], [-rim, 0, 0.9]], edges, faces)


def test_a_superellipsoid_of_several_charts_that_is_cut_is_refused() -> None:
    with pytest.raises(so.StandoffError, match="unless it is whole or an octant") as caught:
        mass_properties(cut_superellipsoid())
    assert caught.value.argument == "body"


@pytest.mark.parametrize(
    ("body", "says"),
    [
        (SHAPES.point(), "has no volume"),
        (SHAPES.segment(1.0), "has no volume"),
        (SHAPES.polygon([[0, 0, 0], [1, 0, 0], [0, 1, 0]]), "has no volume"),
        (SHAPES.halfspace(), "is unbounded"),
        (SHAPES.halfspace(rounding=0.1), "is unbounded"),
        (SHAPES.planar_loop([so.geometry.ConicArc([0, 0], [1, 0], [0, 1])]), "is planar"),
    ],
    ids=["point", "segment", "polygon", "half-space", "rounded half-space", "disc"],
)
def test_bodies_without_mass_are_refused(body: so.Body, says: str) -> None:
    with pytest.raises(so.StandoffError, match=says) as caught:
        mass_properties(body)
    assert "MassProperties.of" in str(caught.value)
    assert caught.value.argument == "body"


@pytest.mark.parametrize("density", [0.0, -1.0, np.nan, np.inf, "steel"])
def test_densities_are_positive(density: float) -> None:
    with pytest.raises(so.StandoffError, match="density"):
        mass_properties(SHAPES.sphere(1.0), density)


def test_only_bodies_have_mass() -> None:
    with pytest.raises(so.StandoffError, match="give a Body"):
        mass_properties("sphere")  # type: ignore[arg-type]


@pytest.mark.parametrize("mass", [0.0, -1.0, np.nan, np.inf])
def test_masses_are_positive(mass: float) -> None:
    with pytest.raises(so.StandoffError, match="mass") as caught:
        MassProperties.of(mass=mass, centre=np.zeros(3), inertia=np.eye(3))
    assert caught.value.argument == "mass"


@pytest.mark.parametrize(
    ("inertia", "says"),
    [
        (np.diag([1.0, 1.0, 2.5]), r"triangle inequality by 0\.5: .* 1, 1 and 2\.5"),
        ([[2, 0.5, 0], [0, 2, 0], [0, 0, 2]], r"not symmetric: .* differ by 0\.5"),
        (np.diag([1.0, 1.0, 0.0]), "not positive definite: its least principal moment is 0"),
        (np.diag([1.0, 1.0, -0.5]), "not positive definite: its least principal moment is -0.5"),
        (np.zeros((3, 3)), "not positive definite"),
        (np.eye(2), "has shape"),
        (np.full((3, 3), np.nan), "NaN"),
    ],
)
def test_inertias_that_no_body_has_are_refused(inertia: np.ndarray, says: str) -> None:
    with pytest.raises(so.StandoffError, match=says) as caught:
        MassProperties.of(mass=1.0, centre=np.zeros(3), inertia=inertia)
    assert caught.value.argument == "inertia"


def test_inertias_at_the_limits_are_taken() -> None:
    plate = MassProperties.of(mass=1.0, centre=[0, 0, 1], inertia=np.diag([1.0, 1.0, 2.0]))
    np.testing.assert_allclose(plate.principal_moments, [1.0, 1.0, 2.0])
    assert plate.volume is None
    assert plate.error == MassErrors(0.0, 0.0, 0.0, 0.0)
    rod = MassProperties.of(mass=1.0, centre=[0, 0, 0], inertia=np.diag([1.0, 1.0, 1e-9]))
    assert rod.principal_moments[0] == 1e-9


def test_mass_properties_are_read_only_and_stay_so_when_stored() -> None:
    found = mass_properties(SHAPES.box(1, 2, 3))
    for one in (found, pickle.loads(pickle.dumps(found))):
        assert not one.centre.flags.writeable
        assert not one.inertia.flags.writeable
        np.testing.assert_array_equal(one.inertia, found.inertia)
