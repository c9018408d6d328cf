"""What cannot be sewn is refused, with the patches, their sides and by how much."""

import re
from itertools import pairwise

import numpy as np
import pytest

import standoff as so
from families import patch_shells as shells
from standoff.bodies.sewing import sew
from standoff.geometry import BezierPatch, Cylinder, Plane, ellipsoid_octants, ellipsoid_patches

IDENTITY = np.eye(3)


def moved(patch, shift):
    return patch.transformed(IDENTITY, np.asarray(shift, dtype=float))


def box_with(number, shift):
    """The box's patches, one moved out of its place."""
    patches = shells.box((1.0, 1.0, 1.0))
    patches[number] = moved(patches[number], shift)
    return patches


def refusal(patches, **options):
    """What is said when no body is made of patches."""
    with pytest.raises(so.BodyError) as error:
        so.Body.from_patches(patches, **options)
    return str(error.value)


def test_an_open_shell_is_told_in_one_sentence_with_the_gaps_and_the_tolerance():
    assert refusal(box_with(5, (0, 0, 3.2e-3))) == (
        "The shell is open: patch 0 side v0 and patch 5 side u0 are 0.0032 apart, patch 1 side v1 "
        "and patch 5 side u1 are 0.0032 apart, patch 2 side u1 and patch 5 side v0 are 0.0032 "
        "apart and 1 more such gap, more than tolerance=1.73e-09 allows; tolerance=0.0033 would "
        "join them."
    )


@pytest.mark.parametrize("shift", [(0, 0, 1e-7), (2e-4, 2e-4, 2e-4), (0, 3e-5, 1e-6)])
def test_the_tolerance_that_a_refusal_names_joins_them(shift):
    patches = box_with(5, shift)
    (offered,) = re.findall(r"; tolerance=(\S+) would join them\.$", refusal(patches))
    shift = np.linalg.norm(shift)
    assert shift < float(offered) < 2.0 * shift
    sewn = sew(patches, float(offered))
    assert sewn.residual == pytest.approx(shift, rel=1e-6)


@pytest.mark.parametrize("shift", [(0, 0, 0.05), (5e-3, 0, 0)])  # too wide; sides that slid
def test_where_no_tolerance_would_do_none_is_offered(shift):
    text = refusal(box_with(5, shift))
    assert text.endswith("and a greater one would not help: a patch is missing or out of place.")
    assert "tolerance=0" not in text


def test_the_tolerance_decides():
    patches = box_with(5, (0, 0, 1e-7))
    assert re.search(
        r"1e-07 apart.*more than tolerance=9e-08 allows", refusal(patches, tolerance=9e-8)
    )
    report = so.Body.from_patches(patches, tolerance=2e-7).check()
    assert report.sewing_residual == pytest.approx(1e-7, rel=1e-6)
    assert report.slack >= report.sewing_residual
    assert report.sewing_tolerance == 2e-7


@pytest.mark.parametrize("missing", [0, 3])
def test_an_open_shell(missing):
    patches = list(ellipsoid_patches(1.0, 0.8, 0.6))
    del patches[missing]
    assert re.search(
        r"The shell is open: patch \d side .* apart.*: a patch is missing or out of place\.$",
        refusal(patches),
    )


def test_one_patch_alone_is_open():
    assert re.search(
        "The shell is open: patch 0 side v0 and patch 0 side .*: a patch is missing",
        refusal(ellipsoid_patches(1, 1, 1)[:1]),
    )


def test_a_patch_given_twice():
    patches = shells.box((1, 2, 3))
    assert re.search(
        r"patch \d side \w\w, patch \d side \w\w, patch 6 side \w\w lie along one curve.*twice",
        refusal([*patches, patches[4]]),
    )


def test_two_shells():
    near, far = shells.box((1, 1, 1)), [moved(p, (5, 0, 0)) for p in shells.box((1, 1, 1))]
    assert re.search(
        r"2 shells that share no side: patches 0, 1, 2, 3, 4, 5 \| patches 6, 7, 8, 9, 10, 11",
        refusal(near + far),
    )


def test_boxes_that_touch_in_a_corner():
    near, far = shells.box((1, 1, 1)), [moved(p, (1, 1, 1)) for p in shells.box((1, 1, 1))]
    assert re.search("2 shells", refusal(near + far))


def sections_of_a_bent_bar():
    """Triangles across an arc that nearly closes, and the point where its ends would meet."""
    arc = [np.array([np.cos(t), np.sin(t), 0.0]) for t in np.linspace(0.5, 2 * np.pi - 0.5, 6)]
    across = np.array([[0, 0, 1], [1, 0, -1], [-1, 0, -1]])
    turns = [np.column_stack([x, np.cross([0, 0, 1], x), [0, 0, 1]]) for x in arc]
    return [3.0 * x + 0.3 * across @ turn.T for x, turn in zip(arc, turns, strict=True)]


def bar(sections):
    """Ruled patches between neighbouring triangles."""
    return [
        BezierPatch([[one[k], other[k]], [one[k - 1], other[k - 1]]])
        for one, other in pairwise(sections)
        for k in range(3)
    ]


def test_a_bar_whose_ends_touch_in_a_point():
    sections, tip = sections_of_a_bent_bar(), np.array([3.0, 0.0, 0.0])
    ends = [
        BezierPatch([[section[k], tip], [section[k - 1], tip]])
        for section in (sections[0], sections[-1])
        for k in range(3)
    ]
    assert re.search(
        r"Patches touch only at the point \[3\. 0\. 0\.\]: 2 fans meet there \(patch 15 side",
        refusal([*bar(sections), *ends]),
    )


def test_a_closed_shell_of_one_side():
    """The tetrahemihexahedron: three squares through the centre, four triangles."""
    x, y, z = np.eye(3)
    squares = [BezierPatch([[a, b], [-b, -a]]) for a, b in ((x, y), (y, z), (z, x))]
    corners = [(x, y, z), (x, -y, -z), (-x, y, -z), (-x, -y, z)]
    triangles = [BezierPatch([[a, c], [b, c]]) for a, b, c in corners]
    assert re.search(
        r"one side only.*patch \d and patch \d cannot both face outward",
        refusal([*squares, *triangles]),
    )


def test_a_sheet_encloses_nothing():
    plane = Plane(IDENTITY, np.zeros(3)).restricted(0, 1, 0, 1)
    back = Plane(np.diag([1.0, 1.0, -1.0]), np.zeros(3)).restricted(0, 1, 0, 1)
    assert re.search("enclose no volume", refusal([plane, back]))


def test_patches_without_extent():
    dot = BezierPatch([[(0, 0, 0), (1e-12, 0, 0)], [(0, 1e-12, 0), (1e-12, 1e-12, 0)]])
    assert re.search(
        "patch 6 has no extent: .* tolerance 1.73e-09", refusal([*shells.box((1, 1, 1)), dot])
    )
    assert re.search("size|open|extent", refusal([dot]))


def test_two_neighbouring_sides_collapsed():
    tip = (0.0, 0.0, 1.0)
    bent = BezierPatch([[tip, tip, tip], [tip, (1, 0, 0), (1, 1, 0)], [tip, (0, 1, 0), (0, 0, 0)]])
    assert re.search(r"patch 0: its sides v0, u0 have collapsed; only one side", refusal([bent]))


@pytest.mark.parametrize(
    ("patches", "words"),
    [
        ([], "No patches"),
        ([Plane(IDENTITY, np.zeros(3))], r"patch 0 is an unbounded Plane.*\.restricted\(u0"),
        ([Cylinder(IDENTITY, np.zeros(3))], "patch 0 is an unbounded Cylinder"),
        (["patch"], "patch 0 is 'patch': give a Surface"),
    ],
)
def test_what_is_no_patch(patches, words):
    assert re.search(words, refusal(patches))


@pytest.mark.parametrize("name", ["tolerance", "convexity_tolerance", "rounding"])
@pytest.mark.parametrize("value", [-1.0, np.nan, np.inf, "wide"])
def test_bad_numbers(name, value):
    with pytest.raises(ValueError, match=f"^{name} "):
        so.Body.from_patches(shells.box((1, 1, 1)), **{name: value})


def test_a_tolerance_beyond_reason():
    assert re.search(
        "tolerance = 1 is not small compared to the patches' size",
        refusal(shells.box((1, 1, 1)), tolerance=1),
    )


def test_corners_chained_by_a_wide_tolerance():
    slim = shells.cube_sphere(8)
    assert re.search("chained|same vertex|extent|collapsed", refusal(slim, tolerance=0.2))


def test_hollow_and_dented_shells():
    patches = shells.box((1.0, 1.0, 1.0))
    a, b, c, d = (np.array(p) for p in ((-1, -1), (1, -1), (-1, 1), (1, 1)))
    top = [np.append(0.5 * p, 0.5) for p in (a, b, c, d)]
    sunk = np.array([0.0, 0.0, 0.2])
    funnel = [
        BezierPatch([[top[i], sunk], [top[j], sunk]]) for i, j in ((0, 1), (1, 3), (3, 2), (2, 0))
    ]
    words = r"edge \d+ between patch \d and patch \d is concave by [\d.]+ degrees at \["
    assert re.search(words, refusal([*patches[:5], *funnel]))


def test_a_bowl_is_hollow():
    """A block whose top is a paraboloid pressed in: convex by itself, the wrong way round."""
    t = np.array([-1.0, 0.0, 1.0])
    square = np.array([[1.0, -1.0, 1.0]])
    height = 2.0 + square + square.T  # control points of z = 2 + u² + v² on [-1, 1]²
    top = np.stack([*np.meshgrid(t, t, indexing="ij"), height], axis=-1)
    floor = top * [1, 1, 0]
    walls = [(top[0], floor[0]), (top[-1], floor[-1]), (top[:, 0], floor[:, 0])]
    walls.append((top[:, -1], floor[:, -1]))
    patches = [top, floor, *(np.stack(wall, axis=1) for wall in walls)]
    assert re.search(
        r"patch 0 \(BezierPatch\) is hollow near",
        refusal([BezierPatch(points) for points in patches]),
    )


def test_a_shell_that_winds_twice_round_its_tips():
    """A bipyramid over a locally convex closed curve of two turns: it crosses itself."""
    turns = 0.2 + np.linspace(0.0, 4.0 * np.pi, 12, endpoint=False)
    ring = [(1.0 + 0.4 * np.cos(0.5 * t)) * np.array([np.cos(t), np.sin(t), 0.0]) for t in turns]
    tips = np.array([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]])
    triangles = [
        BezierPatch([[a, tip], [b, tip]])
        for a, b in zip(ring, [*ring[1:], ring[0]], strict=True)
        for tip in tips
    ]
    assert re.search(r"vertex \d+ .* wind around it 2 times", refusal(triangles))


def test_octants_that_do_not_fit_name_the_octant():
    patches = list(ellipsoid_octants(1, 1, 1))
    patches[3] = ellipsoid_octants(1, 1, 0.9)[3]
    assert re.search(r"patch \d side \w\w and patch 3 side \w\w are 0.1 apart", refusal(patches))
