"""DXF drawings as planar solids."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import standoff as so
from standoff.solids import read_dxf

ezdxf = pytest.importorskip("ezdxf")


def saved(path: Path, draw: Any) -> Path:
    document = ezdxf.new()
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


def test_rounded_rectangles_drawn_clockwise(rng: np.random.Generator, tmp_path: Path) -> None:
    sizes = [(*rng.uniform(2.0, 9.0, 2), float(rng.uniform(0.1, 0.9))) for _ in range(60)]

    def draw(space: Any, document: Any) -> None:
        bulge = -np.tan(np.pi / 8.0)
        for k, (a, b, r) in enumerate(sizes):
            x, y = 12.0 * (k % 8), 12.0 * (k // 8)
            corners = [
                (x, y + r, 0.0),
                (x, y + b - r, bulge),
                (x + r, y + b, 0.0),
                (x + a - r, y + b, bulge),
                (x + a, y + b - r, 0.0),
                (x + a, y + r, bulge),
                (x + a - r, y, 0.0),
                (x + r, y, bulge),
            ]
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
    with pytest.raises(so.BodyError, match="join"):
        read_dxf(path)
    (solid,) = read_dxf(path, join=2e-4)
    assert solid.slack == pytest.approx(1e-4)
