"""DXF drawings as planar solids."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import standoff as so
from standoff.geometry import ConicArc
from standoff.solids import read_dxf

ezdxf = pytest.importorskip("ezdxf")


PARTS = Path(__file__).parents[3] / "shared" / "parts"
"""Drawings that nobody here made, beside the checkout; without them their tests are skipped."""


def saved(path: Path, draw: Any, units: int = 0) -> Path:
    document = ezdxf.new(units=units)
    draw(document.modelspace(), document)
    document.saveas(path)
    return path


def test_a_plate_with_holes(tmp_path: Path) -> None:
    def draw(space: Any, document: Any) -> None:
        space.add_line((10, 0), (10, 5))
        space.add_line((0, 0), (10, 0))
        space.add_line((0, 5), (0, 0))
        space.add_line((0, 5), (10, 5))
        space.add_circle((2, 2), 1)
        space.add_ellipse((6, 2.5), (1.5, 0), 0.5)
        space.add_text("not a curve")
        space.add_lwpolyline([(12, 0, 1), (14, 0, 1)], format="xyb", close=True)

    plate, disc = read_dxf(saved(tmp_path / "plate.dxf", draw), scale=1e-3)
    assert plate.name == "plate"
    assert plate.area == pytest.approx((50 - np.pi - np.pi * 1.5 * 0.75) * 1e-6, rel=1e-13)
    assert disc.area == pytest.approx(np.pi * 1e-6, rel=1e-13)
    answer = so.distance(plate, disc, so.Pose.identity(), so.Pose.identity())
    assert answer.distance == pytest.approx(2e-3, rel=1e-12)


ANGLES = (-90.0, 0.0, 45.0, 180.0, 270.0, 360.0)


@pytest.mark.parametrize("first", ANGLES)
def test_arcs_either_way_round_from_and_to_any_angle(first: float, tmp_path: Path) -> None:
    """A sector of a disc for each angle at which the arc ends, drawn as an arc and as a bulge of
    either sign."""
    turns = [
        (last - first) % 360.0 for last in ANGLES if (last - first) % 360.0 not in (0.0, 180.0)
    ]

    def draw(space: Any, document: Any) -> None:
        for k, turn in enumerate(turns):
            one, other = (
                np.round(10.0 * np.array([np.cos(a), np.sin(a)]), 12)
                for a in np.radians([first, first + turn])
            )
            for row, way in enumerate(("arc", "there", "back")):
                at = np.array([30.0 * k, 30.0 * row])
                a, b = at + one, at + other
                if way == "arc":
                    space.add_arc(at, 10.0, first, (first + turn) % 360.0)
                    space.add_line(b, at)
                    space.add_line(at, a)
                    continue
                bulge = np.tan(np.radians(turn) / 4.0)
                corners = [(*a, bulge), (*b, 0.0), (*at, 0.0)]
                if way == "back":
                    corners = [(*b, -bulge), (*a, 0.0), (*at, 0.0)]
                space.add_lwpolyline(corners, format="xyb", close=True)

    solids = read_dxf(saved(tmp_path / "sectors.dxf", draw))
    areas = sorted(solid.area for solid in solids)
    assert areas == pytest.approx(sorted(np.radians(t) * 50.0 for t in turns * 3), rel=1e-9)


@pytest.mark.parametrize("way", [1, -1])
def test_rounded_rectangles_either_way_round(
    way: int, rng: np.random.Generator, tmp_path: Path
) -> None:
    """Turned in steps of 15 degrees, so that arcs begin and end at all of 0, 90, 180 and 270."""
    sizes = [(*rng.uniform(2.0, 9.0, 2), float(rng.uniform(0.1, 0.9))) for _ in range(24)]

    def draw(space: Any, document: Any) -> None:
        bulge = way * np.tan(np.pi / 8.0)
        for k, (a, b, r) in enumerate(sizes):
            angle = np.radians(15.0 * k)
            turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
            at = np.array([[r, 0], [a - r, 0], [a, r], [a, b - r]])
            at = np.concatenate([at, [[a - r, b], [r, b], [0, b - r], [0, r]]])[::way]
            at = at @ (np.rint(turn) if k % 6 == 0 else turn) + (24.0 * (k % 8), 24.0 * (k // 8))
            bulges = [0.0, bulge] * 4
            corners = [(*p, each) for p, each in zip(at, bulges, strict=True)]
            space.add_lwpolyline(corners, format="xyb", close=True)

    areas = sorted(solid.area for solid in read_dxf(saved(tmp_path / "plates.dxf", draw)))
    assert areas == pytest.approx(
        sorted(a * b - (4 - np.pi) * r * r for a, b, r in sizes), rel=1e-9
    )


def test_splines_blocks_and_mirrored_arcs(tmp_path: Path) -> None:
    def draw(space: Any, document: Any) -> None:
        block = document.blocks.new("half")
        block.add_arc((0, 0), 1, 0, 180)
        block.add_line((-1, 0), (1, 0))
        space.add_blockref("half", (5, 0), dxfattribs={"rotation": 90})
        space.add_arc((3, 0), 1, 0, 180, dxfattribs={"extrusion": (0, 0, -1)})
        space.add_line((-4, 0), (-2, 0))
        spline = space.add_open_spline([(0, 0), (0, 3), (2, 3), (2, 0)], degree=3)
        spline.dxf.layer = "0"
        space.add_line((2, 0), (0, 0))

    solids = read_dxf(saved(tmp_path / "parts.dxf", draw))
    areas = sorted(solid.area for solid in solids)
    assert areas == pytest.approx([0.5 * np.pi, 0.5 * np.pi, 3.6], rel=1e-12)


@pytest.mark.parametrize(
    ("lines", "told"),
    [
        ([((0, 0), (1, 0)), ((1, 0), (1, 1)), ((1, 1), (0.1, 0))], r"ends at \[0"),
        (
            [((0, 0), (1, 0)), ((1, 0), (1, 1)), ((1, 1), (0, 0)), ((0, 0), (1, 0))],
            r"3 curves end at \[0",
        ),
        ([((0, 0), (1, 0)), ((1, 0), (0, 0))], r"crosses or touches itself at \["),
        ([((0, 0), (1, 0)), ((1, 0), (1, 0))], r"no length, at \[1"),
        (
            [((0, 0), (2, 2)), ((2, 2), (2, 0)), ((2, 0), (0, 1)), ((0, 1), (0, 0))],
            r"\[0.66666667 0.66666667\]",
        ),
        ([((0, 0, 1), (1, 0, 1))], "leaves the plane"),
        ([], "no lines or curves"),
    ],
)
def test_what_bounds_nothing(tmp_path: Path, lines: list[Any], told: str) -> None:
    def draw(space: Any, document: Any) -> None:
        for p, q in lines:
            space.add_line(p, q)

    with pytest.raises(so.BodyError, match=told):
        read_dxf(saved(tmp_path / "bad.dxf", draw))


def test_other_files(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        read_dxf(tmp_path / "none.dxf")
    empty = tmp_path / "empty.dxf"
    empty.write_text("")
    with pytest.raises(so.StandoffError, match="no DXF"):
        read_dxf(empty)
    whole = saved(tmp_path / "whole.dxf", lambda space, _: space.add_circle((0, 0), 1))
    cut = tmp_path / "cut.dxf"
    cut.write_bytes(whole.read_bytes()[:2000])
    with pytest.raises(so.StandoffError):
        read_dxf(cut)


def test_doubled_circles_and_gaps(tmp_path: Path) -> None:
    def doubled(space: Any, _: Any) -> None:
        space.add_circle((0, 0), 1)
        space.add_circle((0, 0), 1)

    with pytest.raises(so.BodyError, match="given twice"):
        read_dxf(saved(tmp_path / "doubled.dxf", doubled))

    def gaping(space: Any, _: Any) -> None:
        space.add_line((0, 0), (1, 0))
        space.add_line((1, 1e-4), (1, 1))
        space.add_line((1, 1), (0, 0))

    path = saved(tmp_path / "gap.dxf", gaping)
    with pytest.raises(so.BodyError, match=r"0\.0001 away, the farthest of 2 open.*`join`"):
        read_dxf(path)
    (solid,) = read_dxf(path, join=2e-4)
    assert solid.slack == pytest.approx(1e-4)


UNITS = {1: ("inch", 25.4), 2: ("foot", 304.8), 4: ("mm", 1.0), 5: ("cm", 10.0), 6: ("m", 1e3)}
UNITS |= {9: ("mil", 0.0254), 13: ("micron", 1e-3), 21: ("US survey foot", 1.2e6 / 3937.0)}


@pytest.mark.parametrize("number", UNITS)
def test_the_unit_of_a_drawing(number: int, tmp_path: Path) -> None:
    def draw(space: Any, _: Any) -> None:
        space.add_circle((3, 4), 2)

    path, (name, factor) = saved(tmp_path / "disc.dxf", draw, number), UNITS[number]
    own = read_dxf(path)
    assert (own.unit, own.file_unit) == (name, name)
    assert own[0].area == pytest.approx(4 * np.pi, rel=1e-14)
    assert own.report().startswith(f"disc.dxf: 1 planar solid, lengths in {name}\n")
    for unit, mm in {"mm": 1.0, "cm": 10.0, "m": 1e3, "inch": 25.4}.items():
        drawing = read_dxf(path, unit=unit)
        assert (drawing.unit, drawing.file_unit) == (unit, name)
        assert drawing[0].area == pytest.approx(4 * np.pi * (factor / mm) ** 2, rel=1e-13)
        told = f"lengths in {unit}" + ("" if unit == name else f", converted from {name}")
        assert told in drawing.report()


def test_drawings_that_tell_no_unit_or_a_wrong_one(tmp_path: Path) -> None:
    def draw(space: Any, _: Any) -> None:
        space.add_circle((3, 4), 2)

    none, metres = saved(tmp_path / "a.dxf", draw), saved(tmp_path / "b.dxf", draw, 6)
    drawing = read_dxf(none, unit="m")
    assert (drawing.unit, drawing.file_unit, drawing[0].size) == ("", "", read_dxf(none)[0].size)
    assert "lengths in no known unit\n" in drawing.report()
    for path in (none, metres):
        drawing = read_dxf(path, scale=25.4, unit="mm")
        assert (drawing.unit, drawing.file_unit) == ("mm", "")
        assert drawing[0].area == pytest.approx(4 * np.pi * 25.4**2, rel=1e-13)
    with pytest.raises(so.StandoffError, match=r"unit = 'furlong': give one of \('mm', 'cm'"):
        read_dxf(none, unit="furlong")


def rounded(space: Any, gap: float, rng: np.random.Generator) -> float:
    """A rounded rectangle of lines and arcs whose ends miss each other by `gap` at most: one by
    just that. Returns its area."""
    a, b, r = 10.0, 6.0, 1.0
    corners = [(r, 0), (a - r, 0), (a, r), (a, b - r), (a - r, b), (r, b), (0, b - r), (0, r)]
    middles = [(a - r, r), (a - r, b - r), (r, b - r), (r, r)]
    for k in range(4):
        p, q = (np.array(corners[2 * k + j], float) for j in (0, 1))
        size, angle = (gap if k == 0 else gap * rng.uniform(0, 0.9)), rng.uniform(0, 2 * np.pi)
        p += size * np.array([np.cos(angle), np.sin(angle)])
        space.add_line(*((p, q) if rng.random() < 0.5 else (q, p)))
        space.add_arc(middles[k], r, 90.0 * (k - 1), 90.0 * k)
    return a * b - (4 - np.pi) * r * r


@pytest.mark.parametrize("exponent", range(-12, -2))
def test_ends_are_joined_up_to_a_limit_and_told(
    exponent: int, rng: np.random.Generator, tmp_path: Path
) -> None:
    size = float(np.hypot(10.0, 6.0))
    for share in (0.7, 0.99, 1.05, 3.0):
        gap, areas = share * size * 10.0**exponent, []
        path = saved(tmp_path / "gap.dxf", lambda s, _: areas.append(rounded(s, gap, rng)), 4)  # noqa: B023
        if gap > 1e-5 * size:
            with pytest.raises(so.BodyError, match=r"no other one begins there.*give `join`"):
                read_dxf(path)
            drawing = read_dxf(path, join=1.01 * gap)
        else:
            drawing = read_dxf(path)
        (solid,) = drawing
        assert abs(solid.area - areas[0]) <= solid.area_error + 1e-12
        assert solid.slack == pytest.approx(gap, rel=1e-2, abs=1e-14)
        told = [note for note in drawing.notes if note.startswith("joined")]
        assert len(told) == (gap > 1e-9 * size)
        if told:
            assert f"by up to {solid.slack:.3g} mm, at [" in told[0]
        disc = so.PlanarSolid.from_loops([ConicArc((5, -1), (0.5, 0), (0, 0.5))])
        answer = so.distance(solid, disc, so.Pose.identity(), so.Pose.identity())
        # that of the outline without gaps
        assert answer.lower_bound <= 0.5 + 1e-12
        assert abs(answer.distance - 0.5) <= solid.slack + 1e-9


def test_details_below_the_limit_stay(tmp_path: Path) -> None:
    step = 3e-6  # of a plate 10 wide, whose ends may be joined over 1.2e-4

    def draw(space: Any, _: Any) -> None:
        corners = [(0, 0), (10, 0), (10, 6), (5 + step, 6), (5 + step, 6 - step), (5, 6 - step)]
        corners += [(5, 6 + 4 * step), (0, 6 + 4 * step)]
        for k, p in enumerate(corners):
            space.add_line(p, corners[(k + 1) % len(corners)])

    drawing = read_dxf(saved(tmp_path / "steps.dxf", draw))
    assert (drawing[0].n_edges, drawing[0].slack, drawing.notes) == (8, 0.0, ())


@pytest.mark.parametrize("version", ["R2000", "R2010"])
def test_markers_of_subclasses_that_are_missing(version: str, tmp_path: Path) -> None:
    document = ezdxf.new(version, units=4)
    space = document.modelspace()
    space.add_lwpolyline([(0, 0, 1), (2, 0, 1)], format="xyb", close=True)
    space.add_open_spline([(9, 0), (9, 3), (11, 3), (11, 0)], dxfattribs={"layer": "s"})
    space.add_line((11, 0), (9, 0), dxfattribs={"layer": "s"})
    space.add_mtext("some words")
    whole = tmp_path / "whole.dxf"
    document.saveas(whole)
    lines = whole.read_text().split("\n")
    at = next(k for k in range(1, len(lines), 2) if lines[k] == "ENTITIES") + 1
    end = lines.index("ENDSEC", at)
    pairs = list(zip(lines[at:end:2], lines[at + 1 : end : 2], strict=False))
    bare = [line for pair in pairs if pair[0].strip() != "100" for line in pair]
    path = tmp_path / "bare.dxf"
    path.write_text("\n".join([*lines[:at], *bare, *lines[end - 1 :]]))
    drawing, right = read_dxf(path), read_dxf(whole)
    assert [solid.area for solid in drawing] == [solid.area for solid in right]
    assert right.notes == ()
    (told,) = drawing.notes
    assert told.startswith("added to the file: ")
    assert {"1 LWPOLYLINE without AcDbPolyline", "1 SPLINE without AcDbSpline"} < set(
        told.removeprefix("added to the file: ").split(", ")
    )
    assert len(read_dxf(path, layer="s")) == 1
    path.write_text("\n".join([*lines[:at], *bare]))
    with pytest.raises(so.StandoffError):
        read_dxf(path)


FOREIGN: dict[str, tuple[str, int, int, float, str]] = {
    "1002_tray_bottom.DXF": ("inch", 1, 24, 109561.5221, "in mm, converted from inch"),
    "125_cycloidal.DXF": ("inch", 4, 23, 1453.741426, "up to 4.51e-07 mm"),
    "250_rear.dxf": ("mm", 1, 1, 174911.6072, "lengths in mm"),
    "MC_12x31.dxf": ("inch", 1, 1, 5894.795363, "in mm, converted from inch"),
    "cycloidal.dxf": ("inch", 1, 1, 7175.322531, "added to the file: 1 SPLINE without AcDbSpline"),
    "gear.dxf": ("", 1, 2, 540.8610321, "joined: 4 pairs of ends"),
    "genshi.dxf": ("", 1, 1, 1024.384454, "lengths in no known unit"),
}
"""Unit, solids, loops, area in mm² by points along the curves, what is told."""


@pytest.mark.parametrize("name", FOREIGN)
def test_drawings_that_nobody_here_made(name: str) -> None:
    if not (PARTS / name).exists():
        pytest.skip(f"{PARTS / name} is missing")
    unit, count, loops, area, told = FOREIGN[name]
    drawing = read_dxf(PARTS / name, unit="mm")
    assert (drawing.file_unit, len(drawing)) == (unit, count)
    assert sum(len(solid.loops) for solid in drawing) == loops
    assert sum(solid.area for solid in drawing) == pytest.approx(area, rel=1e-6)
    assert told in drawing.report()
