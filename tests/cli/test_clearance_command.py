"""`standoff clearance`: verdicts and gaps by closed forms, what must hold, and its files."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from html import escape
from html.parser import HTMLParser
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import standoff as so
from standoff.clearance.fits import load_fits
from standoff.clearance.report import LeastGap, Wanted, report_on
from standoff.clearance.tolerances import TOUCHING_PART
from standoff.clearance.verdicts import Verdict, touching_tolerance, verdict_of
from standoff.scene import SceneError
from standoff.world import PairAnswer

Standoff = Callable[..., Any]
ROOT = Path(__file__).parents[2]
DOTALL = re.DOTALL | re.MULTILINE

SCENE = """version = 1
title = "Balls and boxes"
length_unit = "cm"
[bodies.table]
shape = "box"
size = [10.0, 10.0, 1.0]
[bodies.ball]
shape = "sphere"
radius = 1.0
[bodies.pair_of_balls]
shape = "compound"
[bodies.pair_of_balls.pieces.left]
shape = "sphere"
radius = 0.5
position = [-2.0, 0.0, 0.0]
[bodies.pair_of_balls.pieces.right]
shape = "sphere"
radius = 0.5
position = [2.0, 0.0, 0.0]
[bodies.moon]
shape = "sphere"
radius = 1.0
[placements.table]
position = [0.0, 0.0, -0.5]
[placements.ball]
position = [0.0, 0.0, 1.0]
[placements.pair_of_balls]
position = [3.25, 0.0, 1.0]
[placements.moon]
position = [0.0, 0.0, 40.0]
[motions.moon]
kind = "twist"
linear = [0.0, 0.0, -1.0]
[world]
within = 5.0
[track]
step = 0.5
duration = 37.0
"""
# Of each near pair: its verdict and signed distance at time 0. The left ball of the two is at
# x = 1.25, the right one at 5.25, beyond the edge of the table but above it by 0.5.
TRUTH = {
    ("ball", "pair_of_balls"): ("OVERLAPPING", 1.25 - 1.5),
    ("table", "ball"): ("TOUCHING", 0.0),
    ("table", "pair_of_balls"): ("APART", 0.5),
}
CONE = '[bodies.moon]\nshape = "cone"\nradius = 1.0\nheight = 2.0\n'
FITS = 'version = 1\n[[allow]]\na = "table"\nb = "ball"\nreason = "it lies there"\n'


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    file = tmp_path / "balls.toml"
    file.write_text(SCENE, encoding="utf-8")
    return file


@pytest.fixture
def fits(tmp_path: Path) -> Path:
    file = tmp_path / "allowed.toml"
    file.write_text(FITS, encoding="utf-8")
    return file


def facts_of(standoff: Standoff, *arguments: object) -> dict[str, Any]:
    facts: dict[str, Any] = json.loads(standoff("clearance", *arguments, "--json").out)
    return facts


def by_name(facts: dict[str, Any]) -> dict[tuple[str, str], dict[str, Any]]:
    return {(pair["names"][0], pair["names"][1]): pair for pair in facts["pairs"]}


def test_each_pair_has_its_verdict_and_its_gap(standoff: Standoff, scene: Path) -> None:
    facts = facts_of(standoff, scene)
    found = by_name(facts)
    assert {names: pair["verdict"] for names, pair in found.items()} == {
        names: verdict for names, (verdict, _) in TRUTH.items()
    }
    for names, (_, distance) in TRUTH.items():
        pair = found[names]
        assert pair["distance"] == pytest.approx(distance, abs=1e-12)
        assert pair["lower_bound"] <= distance + 1e-15
        assert pair["lower_bound"] == pytest.approx(distance, abs=1e-10)
    assert found["ball", "pair_of_balls"]["pieces"] == ["", "left"]
    # A depth is proven to the thousandth.
    assert found["ball", "pair_of_balls"]["upper_bound"] <= -0.999 * 0.25
    assert facts["verdicts"] == {
        "OVERLAPPING": 1,
        "UNDECIDED": 0,
        "TOUCHING": 1,
        "APART": 4,
        "CONTAINED": 0,
    }
    assert facts["clearance"] == pytest.approx(-0.25, abs=1e-10)
    assert (facts["certified"], facts["holds"]) == (True, True)
    assert (facts["start"], facts["end"], facts["frames"]) == (0.0, 0.0, 1)


def test_points_lie_on_the_bodies(standoff: Standoff, scene: Path) -> None:
    pair = by_name(facts_of(standoff, scene))["table", "ball"]
    np.testing.assert_allclose(pair["point_a"], [0.0, 0.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(pair["point_b"], [0.0, 0.0, 0.0], atol=1e-9)


def test_far_pairs_have_a_bound_that_is_true(standoff: Standoff, scene: Path) -> None:
    far = facts_of(standoff, scene)["far"]
    truth = {
        ("table", "moon"): 39.0,
        ("ball", "moon"): 38.0 - 1.0,
        ("pair_of_balls", "moon"): math.hypot(1.25, 39.0) - 1.5,
    }
    assert far["count"] == 3
    for pair in far["pairs"]:
        assert 5.0 <= pair["at_least"] <= truth[tuple(pair["names"])] + 1e-12
    assert far["at_least"] == min(pair["at_least"] for pair in far["pairs"])


def test_the_horizon_can_be_given(standoff: Standoff, scene: Path) -> None:
    assert facts_of(standoff, scene, "--within", 0.1)["far"]["count"] == 4
    facts = facts_of(standoff, scene, "--within", "inf")
    assert facts["far"]["count"] == 0
    assert by_name(facts)["table", "moon"]["distance"] == pytest.approx(39.0, abs=1e-12)


def test_another_instant(standoff: Standoff, scene: Path) -> None:
    facts = facts_of(standoff, scene, "--time", 35.0)
    assert by_name(facts)["ball", "moon"]["distance"] == pytest.approx(2.0, abs=1e-12)
    ended = standoff("clearance", scene, "--time", 50.0)
    assert ended.code == 2
    assert "outside the scene's times" in ended.err
    assert ended.err.startswith("standoff: --time:")


def test_min_says_which_pairs_do_not_keep_it(standoff: Standoff, scene: Path) -> None:
    ended = standoff("clearance", scene, "--min", 0.3)
    assert ended.code == 3
    told = ended.out[ended.out.index("fails") :]
    assert "ball - pair_of_balls: not proven to keep 0.3: the lower bound is -0.25" in told
    assert "table - ball: not proven to keep 0.3" in told
    assert "table - pair_of_balls" not in told
    # The pair of 0.5 keeps 0.3, and not 0.6.
    facts = facts_of(standoff, scene, "--min", 0.6)
    failing = {names for names, pair in by_name(facts).items() if pair["failure"]}
    assert failing == set(TRUTH)
    assert facts["holds"] is False


def test_min_beyond_the_horizon_is_proven_too(standoff: Standoff, scene: Path) -> None:
    scene.write_text(SCENE.replace("within = 5.0", 'within = 5.0\nonly = [["table", "moon"]]'))
    assert standoff("clearance", scene, "--min", 38.9).code == 0
    assert standoff("clearance", scene, "--min", 39.1).code == 3


def test_min_is_proven_where_the_bound_of_the_boxes_is_not_enough(
    standoff: Standoff, scene: Path
) -> None:
    # A corner of the cone's box is nearer to the ball than its apex, at (10, 0, -9).
    cone = SCENE.replace('[bodies.moon]\nshape = "sphere"\nradius = 1.0\n', CONE)
    scene.write_text(
        cone.replace("position = [0.0, 0.0, 40.0]", "position = [10.0, 0.0, -10.0]").replace(
            "within = 5.0", 'within = 5.0\nonly = [["ball", "moon"]]'
        )
    )
    truth = math.hypot(10.0, 10.0) - 1.0
    (far,) = facts_of(standoff, scene)["far"]["pairs"]
    assert far["at_least"] < truth - 0.2
    assert standoff("clearance", scene, "--min", truth - 0.1).code == 0
    assert standoff("clearance", scene, "--min", truth + 0.1).code == 3


def test_what_is_required_is_asked_of_the_lower_bound() -> None:
    answer = answer_at(0.5)
    found = {("a", "b"): LeastGap(answer, 0.0, 0.25, 1)}
    for least, holds in ((0.2, True), (0.3, False)):
        report = report_on(answer_world(), found, {}, Wanted(least))
        assert (not report.failures) is holds
        assert (report.clearance, report.certified) == (0.25, False)


def test_a_margin_of_the_scene_must_hold(standoff: Standoff, scene: Path) -> None:
    for margin, code in ((0.4, 0), (0.6, 3)):
        rule = f'margins = [["table", "pair_of_balls", {margin}]]'
        scene.write_text(SCENE.replace("within = 5.0", f"within = 0.1\n{rule}"))
        ended = standoff("clearance", scene)
        assert ended.code == code, ended.out
    assert (
        "table - pair_of_balls: not proven to keep 0.6: at least 0.499999999999 apart" in ended.out
    )


@pytest.mark.parametrize("short", [1e-12, 1e-10])
def test_a_nominal_gap_is_kept_within_the_tolerance(
    standoff: Standoff, scene: Path, tmp_path: Path, short: float
) -> None:
    # The pair of balls is 0.5 above the table, less a little: what is asked is not quite there.
    lower = SCENE.replace("position = [3.25, 0.0, 1.0]", f"position = [3.25, 0.0, {1.0 - short!r}]")
    scene.write_text(lower.replace("within = 5.0", 'within = 5.0\nignore = [["ball", "moon"]]'))
    page = tmp_path / "page.html"
    facts = facts_of(standoff, scene, "--min", 0.5, "--page", page)
    assert by_name(facts)["table", "pair_of_balls"]["failure"] is None
    assert short <= facts["min_missed_by"] <= 2.0 * short
    assert "1 pair within the tolerance, less at most" in page.read_text("utf-8")
    strict = "--min-tolerance", 0
    ended = standoff("clearance", scene, "--min", 0.5, "--page", page, *strict)
    assert ended.code == 3
    pair = by_name(facts_of(standoff, scene, "--min", 0.5, *strict))["table", "pair_of_balls"]
    assert pair["tolerance"] == 0.0
    assert 0.5 - pair["least_lower_bound"] == pytest.approx(short, rel=0.1)
    told = re.search(
        r"table - pair_of_balls: not proven to keep 0\.5: at least (\S+) apart, (\S+) too little, "
        r"within the touching tolerance of these parts, (\S+) \(their slack (\S+)\): "
        r"ask for (\S+), and the nominal gap passes",
        ended.out,
    )
    assert told is not None, ended.out
    apart, missing, tolerance, slack, ask = map(float, told.groups())
    assert apart <= pair["least_lower_bound"] < 0.5
    assert 0.5 - pair["least_lower_bound"] <= missing <= 2.0 * short
    assert slack <= pair["touching_within"] <= tolerance
    assert "too little, within the touching tolerance" in page.read_text("utf-8")
    assert 0.5 - tolerance - 1e-9 <= ask < 0.5  # nine digits
    report = standoff("clearance", scene, "--min", ask, "--json", *strict).out
    assert by_name(json.loads(report))["table", "pair_of_balls"]["failure"] is None
    # one that is short by more has no such excuse
    ended = standoff("clearance", scene, "--min", 0.5001)
    assert "too little" in ended.out
    assert "touching tolerance" not in ended.out[ended.out.index("table - pair_of_balls") :]


def test_no_report_says_more_than_is_proven(standoff: Standoff, tmp_path: Path) -> None:
    """A plate of which the gap to a ball is a rounder number less some 1e-12 of it."""
    file, page, out = tmp_path / "near.toml", tmp_path / "near.html", ""
    body = '[bodies.{}]\nshape = "sphere"\nradius = 0.5\n'
    file.write_text(
        "version = 1\n" + body.format("a") + body.format("b") + "[placements.b]\n"
        "position = [1.2999999999974, 0.0, 0.0]\n[world]\n"
    )
    ended = standoff("clearance", file, "--page", page)
    (pair,) = facts_of(standoff, file)["pairs"]
    assert ended.code == 0
    assert "≥ 0.29999999999" in ended.out
    texts = page.read_text("utf-8")
    for out in (ended.out, texts):
        shown = [float(x) for x in re.findall(r"\b0\.(?:29|30*)\d*\b", out)]
        upper = [x for x in shown if x > pair["distance"]]
        assert len(upper) == 1, out  # the upper bound's
        assert all(x <= pair["least_lower_bound"] for x in shown[1:] if x not in upper)


def test_allowed_fits_do_not_fail(standoff: Standoff, scene: Path, fits: Path) -> None:
    # The table and the ball touch, as allowed; the other overlap is not among the fits.
    ended = standoff("clearance", scene, "--allow", fits)
    assert ended.code == 3
    assert "ball - pair_of_balls: overlapping, and not among the fits" in ended.out
    more = '[[allow]]\na = "pair_of_balls"\nb = "ball"\ndepth = 0.25\nreason = "pressed in"\n'
    fits.write_text(FITS + more)
    assert standoff("clearance", scene, "--allow", fits).code == 0
    assert standoff("clearance", scene, "--allow", fits, "--min", 0.4).code == 0
    ended = standoff("clearance", scene, "--allow", fits, "--min", 0.6)
    assert (ended.code, ended.out.count("not proven")) == (3, 1)


def test_an_allowed_fit_that_is_too_deep_fails(standoff: Standoff, scene: Path, fits: Path) -> None:
    more = '[[allow]]\na = "ball"\nb = "pair_of_balls"\ndepth = 0.24\nreason = "pressed in"\n'
    fits.write_text(FITS + more)
    ended = standoff("clearance", scene, "--allow", fits)
    assert ended.code == 3
    assert "ball - pair_of_balls: up to 0.250000000001 deep, and 0.24 is allowed" in ended.out


def test_fits_that_are_no_contacts_are_told(standoff: Standoff, scene: Path, fits: Path) -> None:
    rows = [("table", "pair_of_balls"), ("ball", "moon"), ("ball", "mon")]
    more = "".join(f'[[allow]]\na = "{a}"\nb = "{b}"\nreason = "x"\n' for a, b in rows)
    fits.write_text(FITS + more)
    scene.write_text(
        SCENE.replace("within = 5.0", 'within = 5.0\nignore = [["ball", "pair_of_balls"]]')
    )
    found = facts_of(standoff, scene, "--allow", fits)
    notes = [fit["note"] for fit in found["fits"]]
    assert notes[0] is None
    assert notes[1] == "not in contact: 0.5 apart"
    assert notes[2].startswith("not in contact: at least ")
    assert "no body 'mon'" in notes[3]
    assert "mean 'moon'" in notes[3]
    assert [fit["holds"] for fit in found["fits"]] == [True, False, False, False]
    assert found["holds"] is True
    fits.write_text(FITS.replace("table", "pair_of_balls"))
    found = facts_of(standoff, scene, "--allow", fits)
    assert found["fits"][0]["note"] == "the pair does not count in this world"


@pytest.mark.parametrize(
    ("text", "key", "words"),
    [
        ("", "", "'version' is missing"),
        ("version = 2", "version", "reads version 1"),
        ("version = 1", "", "'allow' is missing"),
        ("version = 1\nallow = []", "allow", "empty list"),
        ("version = 1\nalow = []", "alow", "did you mean 'allow'?"),
        (FITS + "deph = 1", "allow[0].deph", "did you mean 'depth'?"),
        (FITS + "depth = -1", "allow[0].depth", "zero or above"),
        (FITS + "depth = 1\ngap = [0, 1]", "allow[0]", "say the same thing"),
        (FITS + "gap = [1, 0]", "allow[0].gap", "give the least gap first"),
        (FITS + "gap = 1", "allow[0].gap", ""),
        (FITS.replace('reason = "it lies there"', ""), "allow[0]", "'reason' is missing"),
        (FITS.replace('"table"', '"ball"'), "allow[0]", "'ball' is both"),
        (FITS + FITS.removeprefix("version = 1\n"), "allow[1]", "same pair as allow[0]"),
        (FITS.replace('"table"', "3"), "allow[0].a", "string in quotes"),
        ("version", "", "is not TOML"),
    ],
)
def test_a_bad_list_of_fits_is_refused(
    standoff: Standoff, scene: Path, fits: Path, text: str, key: str, words: str
) -> None:
    fits.write_text(text)
    with pytest.raises(SceneError) as caught:
        load_fits(fits)
    assert caught.value.key == key
    assert words in caught.value.problem
    ended = standoff("clearance", scene, "--allow", fits)
    assert (ended.code, ended.out) == (2, "")
    assert "allowed.toml" in ended.err


def test_over_the_motion(standoff: Standoff, scene: Path) -> None:
    # The moon comes down from z = 40 at 1 cm/s for 37 s, and is at rest to no other body.
    facts = facts_of(standoff, scene, "--motion")
    assert (facts["frames"], facts["start"], facts["end"]) == (75, 0.0, 37.0)
    pair = by_name(facts)["ball", "moon"]
    assert pair["time"] == 37.0
    assert pair["distance"] == pytest.approx(0.0, abs=1e-12)
    assert pair["verdict"] == "TOUCHING"
    beside = by_name(facts)["pair_of_balls", "moon"]
    assert beside["distance"] == pytest.approx(math.hypot(1.25, 2.0) - 1.5, abs=1e-12)
    assert by_name(facts)["table", "ball"]["time"] == 0.0
    ended = standoff("clearance", scene, "--motion", "--min", 0.1)
    assert ended.code == 3
    assert "75 from 0 s to 37 s" in ended.out
    assert "ball - moon: not proven to keep 0.1" in ended.out


def test_the_least_over_time_is_that_of_a_frame_in_between(standoff: Standoff, scene: Path) -> None:
    # Past the ball at a distance: nearest at 20 s, 1 cm beside it.
    passing = SCENE.replace("position = [0.0, 0.0, 40.0]", "position = [0.0, 3.0, 21.0]")
    scene.write_text(passing.replace("within = 5.0", 'within = 5.0\nonly = [["ball", "moon"]]'))
    pair = by_name(facts_of(standoff, scene, "--motion"))["ball", "moon"]
    assert pair["time"] == 20.0
    assert pair["distance"] == pytest.approx(1.0, abs=1e-12)
    np.testing.assert_allclose(pair["point_b"], [0.0, 2.0, 1.0], atol=1e-9)


def test_options_that_do_not_go_together(standoff: Standoff, scene: Path, tmp_path: Path) -> None:
    cases = {
        ("--motion", "--time", "1"): "--time and --motion",
        ("--min", "-0.1"): "--min: must be zero or more",
        ("--min", "nan"): "--min: must be zero or more",
        ("--within", "0"): "--within: must be above zero",
        ("--min-tolerance", "inf"): "--min-tolerance: must be zero or more and finite",
        ("--closest", "0"): "--closest: must be one or more",
        ("--parts", "moom"): "--parts: there is no body 'moom'. Did you mean 'moon'?",
        ("--pairs", "ball", "b"): "--pairs: there is no body 'b'.",
        ("--allow", str(tmp_path / "none.toml")): "no file",
        ("--page", str(tmp_path / "page.htm")): "the ending '.htm' is not known",
        ("--plot", str(tmp_path / "plot.gif")): "the ending '.gif' is not known",
        ("--page", str(tmp_path / "none" / "page.html")): "does not exist",
    }
    for options, words in cases.items():
        ended = standoff("clearance", scene, *options)
        assert (ended.code, ended.out) == (2, ""), options
        assert words in ended.err


def test_a_scene_of_a_pair_has_that_pair(standoff: Standoff, passing: Path) -> None:
    facts = facts_of(standoff, passing)
    assert [pair["names"] for pair in facts["pairs"]] == [["tool", "part"]]
    alone = json.loads(standoff("distance", passing, "--json").out)
    assert facts["pairs"][0]["distance"] == alone["distance"]


def test_what_asks_for_a_pair_names_the_command(standoff: Standoff, scene: Path) -> None:
    for command in ("distance", "impact", "automaton"):
        ended = standoff(command, scene)
        assert ended.code == 2
        assert "`standoff clearance`" in ended.err
    ended = standoff("check", scene, "--json")
    assert ended.code == 0
    assert '"pair_of_balls.left"' in ended.out


def test_names_that_a_terminal_would_obey_are_shown_as_escapes(
    standoff: Standoff, scene: Path, tmp_path: Path
) -> None:
    scene.write_text(SCENE.replace("moon", '"mo\\u001b[1mon<b>"'))
    page = tmp_path / "page.html"
    ended = standoff("clearance", scene, "--within", 100, "--page", page)
    assert "\x1b" not in ended.out
    assert "mo\\x1b[1mon<b>" in ended.out
    text = page.read_text("utf-8")
    assert "\x1b" not in text
    assert "on<b>" not in text
    assert "on&lt;b&gt;" in text


class Reader(HTMLParser):
    """What a page holds: tags that stay open, texts, and what it would load."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.texts: list[str] = []
        self.loads: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag not in ("meta", "br", "img"):
            self.open.append(tag)
        self.loads += [value or "" for name, value in attrs if name in ("src", "href")]

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.texts.append(data)


@pytest.mark.parametrize("motion", [False, True])
def test_the_page_holds_all_and_loads_nothing(
    standoff: Standoff, scene: Path, fits: Path, tmp_path: Path, motion: bool
) -> None:
    page, plot = tmp_path / "page.html", tmp_path / "plot.png"
    options = ["--motion"] if motion else []
    ended = standoff(
        *("clearance", scene, "--min", 0.3, "--allow", fits, "--page", page, "--plot", plot),
        *options,
    )
    assert ended.code == 3
    assert f"wrote         {page}" in ended.out
    reader = Reader()
    reader.feed(page.read_text("utf-8"))
    assert reader.open == []
    assert len(reader.loads) == 2
    assert all(source.startswith("data:image/png;base64,") for source in reader.loads)
    texts = " ".join(reader.texts)
    for words in (
        "Balls and boxes",
        "OVERLAPPING",
        "TOUCHING",
        "pair_of_balls left",
        "it lies there",
    ):
        assert words in texts
    assert "not proven to keep 0.3: the lower bound is -0.25" in texts
    assert plot.read_bytes().startswith(b"\x89PNG")


def test_a_planar_world_is_drawn_in_its_plane(standoff: Standoff, tmp_path: Path) -> None:
    disk = '[bodies.{0}]\nshape = "planar_loop"\n[[bodies.{0}.curves]]\nkind = "ellipse"\n'
    disk += "centre = [0.0, 0.0]\nsemi_axes = [1.0, 1.0]\n"
    file = tmp_path / "disks.toml"
    place = "[placements.b]\nposition = [2.5, 0.0]\n[world]\n"
    file.write_text("version = 1\n" + disk.format("a") + disk.format("b") + place)
    page = tmp_path / "disks.html"
    ended = standoff("clearance", file, "--page", page, "--json")
    assert ended.code == 0
    (pair,) = json.loads(ended.out)["pairs"]
    assert pair["distance"] == pytest.approx(0.5, abs=1e-12)
    assert page.exists()


def answer_world(sizes: tuple[float, float] = (1.0, 1.0)) -> so.World:
    a, b = (so.shapes.sphere(0.5 * size) for size in sizes)
    return so.World({"a": a, "b": b})


def answer_at(gap: float, sizes: tuple[float, float] = (1.0, 1.0)) -> PairAnswer:
    world = answer_world(sizes)
    at = so.Pose(np.eye(3), [0.5 * sum(sizes) + gap, 0.0, 0.0])
    return world.distances({"a": so.Pose.identity(), "b": at})["a", "b"]


@pytest.mark.parametrize(
    ("gap", "verdict"),
    [
        (1e-3, Verdict.APART),
        (1e-8, Verdict.APART),
        (1e-10, Verdict.TOUCHING),
        (0.0, Verdict.TOUCHING),
        (-1e-10, Verdict.TOUCHING),
        (-1e-8, Verdict.OVERLAPPING),
        (-0.5, Verdict.OVERLAPPING),
    ],
)
def test_verdicts_beside_the_tolerance(gap: float, verdict: Verdict) -> None:
    assert verdict_of(answer_at(gap)) is verdict
    assert Verdict.APART.meaning


@pytest.mark.parametrize(
    ("bounds", "status", "verdict"),
    [
        ((-0.1, 0.1, 0.1), so.Status.NOT_CERTIFIED, Verdict.UNDECIDED),
        ((-0.1, 0.0, 0.0), so.Status.NOT_CERTIFIED, Verdict.UNDECIDED),
        ((-0.1, 0.0, 0.0), so.Status.OVERLAPPING, Verdict.UNDECIDED),
        ((-0.1, -0.05, -0.07), so.Status.OVERLAPPING, Verdict.OVERLAPPING),
        ((-0.1, -0.05, -0.1), so.Status.LOCAL, Verdict.OVERLAPPING),
        ((0.01, 0.1, 0.1), so.Status.NOT_CERTIFIED, Verdict.APART),
        ((-0.1, -0.05, -0.1), so.Status.NOT_CERTIFIED, Verdict.UNDECIDED),
    ],
)
def test_nothing_is_said_that_is_not_proven(
    bounds: tuple[float, float, float], status: so.Status, verdict: Verdict
) -> None:
    lower, upper, distance = bounds
    answer: Any = SimpleNamespace(
        far=False,
        lower_bound=lower,
        upper_bound=upper,
        distance=distance,
        status=status,
        certified=status.certified,
        bodies=(so.shapes.sphere(1.0),),
    )
    assert verdict_of(answer) is verdict


def test_frames_that_are_not_certified_are_told(
    standoff: Standoff, passing: Path, tmp_path: Path
) -> None:
    # The paper's law with a low gain lags behind: its bounds hold, its answers are not proven.
    law = 'law = "paper"\nrestarts = false\ngain = 2.0\n'
    passing.write_text(passing.read_text().replace("[track]\n", f"[track]\n{law}"))
    facts = facts_of(standoff, passing, "--motion")
    (pair,) = facts["pairs"]
    assert pair["uncertified_frames"] > 0
    assert (pair["certified"], facts["certified"]) == (False, False)
    ended = standoff("clearance", passing, "--motion")
    told = re.search(r"^not certified tool - part: (.+) in \d+ frames", ended.out, re.MULTILINE)
    assert told is not None, ended.out
    assert told[1].split(", ") == pair["uncertified_as"] == list(facts["advice"])
    page = tmp_path / "page.html"
    assert standoff("clearance", passing, "--motion", "--page", page).code == 0
    for name in pair["uncertified_as"]:
        advice = so.Status[name].advice
        assert facts["advice"][name] == advice
        assert f"{name}: {advice}" in ended.out
        assert f"{name}: {escape(advice)}" in page.read_text("utf-8")
    # nothing was asked; what is asked and holds by the bounds is proven
    assert ended.code == 0
    least = pair["least_lower_bound"]
    assert least > 0.0
    for asked, code in ((0.9 * least, 0), (1.1 * least, 3)):
        assert standoff("clearance", passing, "--motion", "--min", asked).code == code


def test_the_tolerance_is_of_the_larger_body() -> None:
    slack = touching_tolerance(answer_at(1.0, (1.0, 1e-6))) / TOUCHING_PART
    assert slack == pytest.approx(answer_at(1.0).bodies[0].size, rel=1e-3)
    assert verdict_of(answer_at(-1e-7, (1000.0, 1.0))) is Verdict.TOUCHING
    assert verdict_of(answer_at(-1e-7, (1.0, 1.0))) is Verdict.OVERLAPPING


def test_the_table_is_sorted_worst_first(standoff: Standoff, scene: Path) -> None:
    out = standoff("clearance", scene).out
    found = re.findall(r"^ (OVERLAPPING|TOUCHING|APART) ", out, re.MULTILINE)
    assert found == ["OVERLAPPING", "TOUCHING", "APART"]
    assert "far           3 pairs, proven to be " in out
    assert "verdicts      1 OVERLAPPING, 1 TOUCHING, 4 APART" in out


NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[-+]\d+)?")


def test_the_page_of_the_docs_shows_what_is_printed(
    standoff: Standoff, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(ROOT)
    page = (ROOT / "docs" / "clearance.md").read_text("utf-8")
    (block,) = re.findall(
        r"```console\n\$ standoff (.*?)\n```\n\n```text\n(.*?)^```$", page, DOTALL
    )
    command, promised = block
    ended = standoff(*command.split())
    assert ended.code == 3
    # The bounds of bodies that touch are roundoff, which differs from machine to machine.
    texts = [NUMBER.sub("#", text).split() for text in (ended.out, promised)]
    assert texts[0] == texts[1]
    numbers = [[float(x) for x in NUMBER.findall(text)] for text in (ended.out, promised)]
    np.testing.assert_allclose(numbers[0], numbers[1], rtol=1e-9, atol=1e-9)


def test_the_list_of_fits_on_the_page_can_be_read(tmp_path: Path) -> None:
    page = (ROOT / "docs" / "clearance.md").read_text("utf-8")
    (text,) = re.findall(r"```toml\n(.*?)^```$", page, DOTALL)
    file = tmp_path / "fits.toml"
    file.write_text(text)
    assert load_fits(file)[0] in load_fits(ROOT / "examples" / "fits-allowed.toml")


def pairs_of(facts: dict[str, Any]) -> set[tuple[str, ...]]:
    near = [pair["names"] for pair in facts["pairs"]]
    return {tuple(names) for names in (*near, *(pair["names"] for pair in facts["far"]["pairs"]))}


def test_only_the_pairs_that_are_named_are_looked_at(standoff: Standoff, scene: Path) -> None:
    every = {*TRUTH, ("table", "moon"), ("ball", "moon"), ("pair_of_balls", "moon")}
    for options, left in (
        ((), every),
        (("--parts", "*ball*"), {("ball", "pair_of_balls")}),
        (("--parts", "ball", "--parts", "mo?n"), {("ball", "moon")}),
        (("--pairs", "moon", "*"), {names for names in every if "moon" in names}),
        (
            ("--pairs", "ball", "table", "--pairs", "table", "moon"),
            {("table", "ball"), ("table", "moon")},
        ),
        (("--parts", "[tb]a*", "--pairs", "*", "ball"), {("table", "ball")}),
    ):
        facts = facts_of(standoff, scene, *options)
        assert pairs_of(facts) == left, options
        assert facts["holds"]
    # over the motion too
    assert pairs_of(facts_of(standoff, scene, "--motion", "--parts", "*ball*")) == {
        ("ball", "pair_of_balls")
    }


def test_without_a_horizon_as_many_pairs_as_are_asked_have_distances(
    standoff: Standoff, scene: Path
) -> None:
    scene.write_text(SCENE.replace("within = 5.0", ""))
    assert facts_of(standoff, scene)["within"] is None
    facts = facts_of(standoff, scene, "--closest", 2)
    assert 2 <= len(facts["pairs"]) <= 3
    assert {("ball", "pair_of_balls"), ("table", "ball")} <= set(by_name(facts))
    assert facts["far"]["at_least"] >= facts["within"] > 0.0
    assert {*TRUTH} <= set(by_name(facts_of(standoff, scene, "--closest", 3)))
    assert facts_of(standoff, scene, "--closest", 2, "--within", "inf")["far"]["count"] == 0
    # what is asked needs no more than that
    facts = facts_of(standoff, scene, "--min", 0.3)
    assert (facts["within"], set(by_name(facts))) == (0.3, {*TRUTH} - {("table", "pair_of_balls")})
    out = standoff("clearance", scene, "--min", 0.3, "--verbose").out
    assert re.search(r"APART +table +≥ 0\.4\d+ *\n +pair_of_balls", out), out


def test_a_range_of_gaps_and_patterns_of_names(standoff: Standoff, scene: Path, fits: Path) -> None:
    play = '[[allow]]\na = "t*e"\nb = "pair*"\ngap = [{}, {}]\nreason = "play"\n'
    press = '[[allow]]\na = "*b*ll*"\nb = "*ball*"\ngap = [-0.3, -0.2]\nreason = "press"\n'
    for low, high, told in (
        (0.4, 0.5, ""),
        (0.1, 0.3, "a gap more than is allowed: at least 0.4"),
        (0.6, 0.7, "a gap less than is allowed: at most 0.5"),
    ):
        fits.write_text(FITS + play.format(low, high) + press)
        facts = facts_of(standoff, scene, "--allow", fits, "--within", 0.01)
        pairs = facts["pairs"] + facts["far"]["pairs"]
        (found,) = [pair for pair in pairs if pair["names"] == ["table", "pair_of_balls"]]
        assert (found["failure"] or "").startswith(told)
        assert facts["holds"] is (not told)
        assert facts["fits"][1]["gap"] == [low, high]
        assert [fit["holds"] for fit in facts["fits"]] == [True, not told, True]
    out = standoff("clearance", scene, "--allow", fits).out
    assert "*b*ll* - *ball*, a depth of 0.2 to 0.3 cm (press)" in out
    # the first entry that a pair fits is its fit
    fits.write_text(FITS + play.format(0.4, 0.6) + play.format(0.0, 0.1).replace("t*e", "table"))
    facts = facts_of(standoff, scene, "--allow", fits)
    assert facts["fits"][2]["note"] == "the pair is that of an earlier fit"
    # of several pairs how many fail
    fits.write_text(FITS + press.replace('"*ball*"', '"*"'))
    facts = facts_of(standoff, scene, "--allow", fits)
    assert facts["fits"][1]["note"].startswith("3 of 4 pairs: ")
