"""Verdicts of ten assemblies by closed forms; what bounds leave out is left out rightly."""

from __future__ import annotations

import math
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

import standoff as so
from on_first_use import OnFirstUse
from standoff.clearance.assembly import AssemblyFile
from standoff.clearance.assembly_picture import assembly_figure
from standoff.clearance.checked_pairs import Scope, check
from standoff.clearance.fits import Fit
from standoff.clearance.page import page_of
from standoff.clearance.report import Instants, Report, Wanted
from standoff.clearance.verdicts import Verdict
from standoff.solids import Solid
from standoff_studies.soak.solid_parts import bolt, bracket, hollow, plate, ring

Pair = tuple[str, str]
APART, TOUCHING, OVERLAPPING, CONTAINED = (
    *(Verdict.APART, Verdict.TOUCHING),
    *(Verdict.OVERLAPPING, Verdict.CONTAINED),
)
SHAPES = OnFirstUse(
    {
        "plate": lambda: Solid(plate(8.0, 1.0, 1.1).boundary),
        "bolt": lambda: Solid(bolt(1.0, 2.0, 3.0, 4.0).boundary),
        "washer": lambda: Solid(ring(1.3, 0.2).boundary),
        "hollow": lambda: Solid(hollow(2.0, 1.0).boundary),
        "bracket": lambda: Solid(bracket(4.0, 1.0, 2.0).boundary),
        "box": lambda: so.shapes.box((1.0, 1.0, 1.0)),
        "ball": lambda: so.shapes.sphere(1.0),
        "bead": lambda: so.shapes.sphere(0.2),
    }
)


class Assembly(NamedTuple):
    """Parts by name: a shape and a place. Of some pairs the verdict and the signed gap. And what is
    asked, with the pairs that fail."""

    parts: dict[str, tuple[str, tuple[float, float, float]]]
    truth: dict[Pair, tuple[Verdict, float]]
    asked: list[tuple[Wanted, set[Pair]]]


def meant(a: str, b: str, low: float, high: float = math.inf) -> Wanted:
    return Wanted(None, (Fit(a, b, (low, high), "meant"),))


LATTICE = {f"ball {k}": at for k, at in enumerate(product((0.0, 2.5, 5.0), repeat=3))}
GAPS = {(a, b): math.dist(LATTICE[a], LATTICE[b]) - 2.0 for a in LATTICE for b in LATTICE if a < b}
NEIGHBOURS = {names for names, gap in GAPS.items() if gap < 0.6}
HEAD = ("washer 1", "bolt"), ("washer 2", "bolt")
IN_HOLE, BESIDE = ("plate", "bolt"), ("one", "two")
ASSEMBLIES = {
    "boxes in a row": Assembly(
        {name: ("box", (1.3 * k, 0.0, 0.0)) for k, name in enumerate(("one", "two", "three"))},
        {BESIDE: (APART, 0.3), ("two", "three"): (APART, 0.3), ("one", "three"): (APART, 1.6)},
        [
            (Wanted(0.3), set()),
            (Wanted(0.3000001), {BESIDE, ("two", "three")}),
            (Wanted(0.3000001, None, 1e-6), set()),
            (Wanted(0.29), set()),
        ],
    ),
    "boxes on each other": Assembly(
        {"one": ("box", (0.0, 0.0, 0.0)), "two": ("box", (0.25, 0.0, 1.0))},
        {BESIDE: (TOUCHING, 0.0)},
        [
            (Wanted(0.0, None, 1e-6), {BESIDE}),
            (meant("one", "t*", 0.0), set()),
            (meant("one", "two", 0.01, 0.02), {BESIDE}),
        ],
    ),
    "corner to corner": Assembly(
        {"one": ("box", (0.0, 0.0, 0.0)), "two": ("box", (1.2, -1.2, 1.2))},
        {BESIDE: (APART, 0.2 * 3**0.5)},
        [(Wanted(0.34), set()), (Wanted(0.35), {BESIDE})],
    ),
    "a bolt with play": Assembly(
        {"plate": ("plate", (0.0, 0.0, 1.0)), "bolt": ("bolt", (0.03, 0.04, -0.5))},
        {IN_HOLE: (APART, 0.05)},
        [
            (Wanted(0.04), set()),
            (Wanted(0.06), {IN_HOLE}),
            (meant("bolt", "plate", 0.05, 0.05), set()),
            (meant("bolt", "plate", 0.01, 0.03), {IN_HOLE}),
            (meant("bolt", "plate", 0.06, 0.3), {IN_HOLE}),
            (meant("bolt", "plate", 0.0), set()),
        ],
    ),
    "washers by a pattern": Assembly(
        {"bolt": ("bolt", (0.0, 0.0, 0.0))}
        | {f"washer {k}": ("washer", (0.01 * k, 0.0, 1.2 * k)) for k in (1, 2)},
        {pair: (APART, 0.1 - 0.01 * k) for k, pair in enumerate(HEAD, 1)}
        | {("washer 1", "washer 2"): (APART, 0.8)},
        [
            (meant("washer [12]", "bolt", 0.08, 0.09), set()),
            (meant("w*", "bolt", 0.075, 0.085), {HEAD[0]}),
            (Wanted(0.1, (Fit("w*", "bolt", (0.05, 0.1), "meant"),)), set()),
        ],
    ),
    "a bead in a cavity": Assembly(
        {"hollow": ("hollow", (0.0, 0.0, 0.0)), "bead": ("bead", (0.1, 0.0, 0.3))},
        {("hollow", "bead"): (APART, 0.5)},
        [(Wanted(0.4), set()), (Wanted(0.6), {("hollow", "bead")})],
    ),
    "a bead in the material": Assembly(
        {"plate": ("plate", (0.0, 0.0, 0.0)), "bead": ("bead", (3.0, 3.0, 0.5))},
        {("plate", "bead"): (CONTAINED, 0.3)},
        [
            (Wanted(1e-3), {("plate", "bead")}),
            (meant("plate", "bead", -1.0), {("plate", "bead")}),
            (Wanted(), set()),
        ],
    ),
    "a ball pressed into a plate": Assembly(
        {"plate": ("plate", (0.0, 0.0, 0.0)), "ball": ("ball", (2.6, 2.6, 1.98))},
        {("plate", "ball"): (OVERLAPPING, -0.02)},
        [
            (Wanted(0.1), {("plate", "ball")}),
            (meant("plate", "ball", -0.021), set()),
            (meant("plate", "ball", -0.019), {("plate", "ball")}),
            (meant("plate", "ball", -0.03, -0.01), set()),
            (meant("plate", "ball", -0.05, -0.03), {("plate", "ball")}),
        ],
    ),
    "a box in the corner of a bracket": Assembly(
        {"bracket": ("bracket", (0.0, 0.0, 0.0)), "box": ("box", (1.75, 1.85, 1.0))},
        {("bracket", "box"): (APART, 0.25)},
        [(Wanted(0.25), set()), (Wanted(0.26), {("bracket", "box")})],
    ),
    "a lattice of balls": Assembly(
        {name: ("ball", at) for name, at in LATTICE.items()},
        {names: (APART, gap) for names, gap in GAPS.items()},
        [(Wanted(0.5), set()), (Wanted(0.51), NEIGHBOURS)],
    ),
}
SCOPES = {"all": Scope(within=math.inf), "asked": Scope(), "closest": Scope(closest=1)}


def names_of(pairs: Any) -> set[frozenset[str]]:
    return {frozenset(pair) for pair in pairs}


def reported(assembly: Assembly, wanted: Wanted, scope: Scope) -> Report:
    world = so.World({name: SHAPES[shape] for name, (shape, _) in assembly.parts.items()})
    places = {name: so.Pose(np.eye(3), at) for name, (_, at) in assembly.parts.items()}
    return check(world, places, wanted, scope)


@pytest.mark.parametrize("scope", SCOPES)
@pytest.mark.parametrize("name", ASSEMBLIES)
def test_the_verdicts_of_an_assembly(name: str, scope: str) -> None:
    assembly = ASSEMBLIES[name]
    for wanted, failing in assembly.asked:
        report = reported(assembly, wanted, SCOPES[scope])
        assert names_of(pair for pair, _ in report.failures) == names_of(failing), wanted
        near = {frozenset(row.names): row for row in report.rows}
        far = {frozenset(each.names): each for each in report.far}
        assert len(near) + len(far) == math.comb(len(assembly.parts), 2)
        for pair, (verdict, gap) in assembly.truth.items():
            row = near.get(frozenset(pair))
            if row is None:
                assert verdict is APART
                assert report.world.within <= far[frozenset(pair)].bound <= gap
                continue
            assert row.verdict is verdict, pair
            assert row.answer.distance == pytest.approx(gap, abs=1e-3 * abs(gap) + 1e-8)
            assert row.nearest.lower_bound <= gap + 1e-14 <= row.answer.upper_bound + 1e-9
        if verdict_needs_no_distance(wanted, scope):
            assert report.world.within <= 1.001 * wanted.reach + 1e-6


def verdict_needs_no_distance(wanted: Wanted, scope: str) -> bool:
    """Is the horizon that of the clearance that is asked?"""
    return bool(wanted.least) and scope != "all"


def test_the_page_tells_of_cavities_and_has_the_files_colours() -> None:
    assembly = ASSEMBLIES["a bead in a cavity"]
    report = reported(assembly, Wanted(0.4), Scope(within=1.0))
    places = {name: so.Pose(np.eye(3), at) for name, (_, at) in assembly.parts.items()}
    blue = (0.0, 0.0, 1.0)
    file = AssemblyFile(Path("a.step"), "A bead", "mm", (), places, {"bead": blue})
    assert "<br>bead, in a cavity</td>" in page_of(file, report, Instants(0.0, 0.0, 1))
    figure = assembly_figure(report, places, "mm", file.colours)
    patches = {
        patch.get_label(): patch.get_facecolor() for patch in figure.legends[0].get_patches()
    }
    assert patches["bead"][:3] == blue
    assert patches["hollow"][:3] != blue
