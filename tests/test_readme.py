"""The README's four things print what it says, and their answers are right."""

import math
import re
from contextlib import chdir, redirect_stdout
from functools import cache
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import standoff as so
from oracles.bounds import gap
from printed import assert_same_but_roundoff
from standoff.cli import main
from standoff_studies.oracles import Ellipsoid, Lens, Placed

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
LINK = re.compile(r"\]\(([^)#\s]+)")
HEADING = re.compile(r"^## (.*)$", re.MULTILINE)
# A block of code or a command, and the block right after it with what it prints.
SHOWN = re.compile(r"^```(python|sh)\n([^`]*)```\n\n```text\n([^`]*)```$", re.MULTILINE)
PAIR, ASSEMBLY, ROBOT, LOOP = range(4)
MOST_LINES = 6
"""Of each of the four things, imports aside."""
MOST_LINES_OF_ALL = 190
# What users look for, and the pages that derive it.
SOUGHT = (
    *("quick-start", "ten-tasks", "coming-from", "derivatives", "differentiable", "many-poses"),
    *("fast-loops", "c-interface", "servo", "live-page", "time-of-impact", "answers"),
    *("solid-distance", "worlds", "robots", "cad", "planar-solids", "scene-format"),
)
DERIVED = ("architecture", "symbols", "pair-system", "laws", "automaton", "certificate")
# A page for use, and the page that says how it works and why it is right.
HALVES = (
    ("answers", "options"),
    ("time-of-impact", "impact-proof"),
    ("servo", "servo-loop"),
    ("coupler", "coupler-passivity"),
)
# What the library was before it had solids and worlds; none of the pages that say what it is may.
FRONT = (
    *("README.md", "docs/index.md", "docs/benchmarks.md", "docs/boundaries.md", "CITATION.cff"),
    *("docs/coming-from.md", "docs/ten-tasks.md", "pyproject.toml", "src/standoff/__init__.py"),
    "src/standoff/cli/arguments.py",
)
OUTDATED = (
    *("curved convex", "one pair at a time", "two convex bodies with", "choose the pairs yourself"),
    *("no broad phase", "without a broad phase", "bodies only, for now", "*bodies that are not co"),
)


def shown() -> list[tuple[str, str, str]]:
    """Language, code and what it prints, of each of the four things."""
    found = SHOWN.findall(README)
    assert [language for language, _, _ in found] == ["python", "sh", "python", "python"]
    return [(str(a), str(b), str(c)) for a, b, c in found]


@cache
def run(which: int) -> tuple[dict[str, Any], str]:
    """The names that a block of Python has at its end, and what it printed."""
    names: dict[str, Any] = {}
    with chdir(ROOT), redirect_stdout(StringIO()) as printed:
        exec(compile(shown()[which][1], "README.md", "exec"), names)
    return names, printed.getvalue()


@pytest.mark.parametrize("which", [PAIR, ROBOT, LOOP])
def test_each_block_prints_what_the_readme_says(which: int) -> None:
    assert run(which)[1] == shown()[which][2]


def test_the_command_prints_what_the_readme_says(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("OCP")
    monkeypatch.chdir(ROOT)
    _, command, promised = shown()[ASSEMBLY]
    name, *arguments = command.split()
    assert name == "standoff"
    (status,) = re.findall(r"The exit code is (\d)", README)
    assert main(arguments) == int(status)
    printed = capsys.readouterr().out
    assert printed.count("\n") == promised.count("\n")
    assert_same_but_roundoff(printed, promised)


def test_no_thing_takes_more_lines_than_a_reader_has_patience_for() -> None:
    for _, code, _ in shown():
        lines = [line for line in code.splitlines() if line]
        assert sum("import " not in line for line in lines) <= MOST_LINES, code
        assert max(map(len, lines)) <= 100, code
    assert README.count("\n") <= MOST_LINES_OF_ALL


def test_the_answer_of_the_loop_is_the_minimum_distance() -> None:
    names, _ = run(LOOP)
    answer, pose = names["answer"], names["path"].pose(1.0)
    lens = Placed(Lens(1.0, 0.45), np.eye(3), np.zeros(3))
    tool = Placed(Ellipsoid(0.15, 0.30, 0.20), pose.rotation, pose.translation)
    assert answer.certified
    assert abs(gap(answer.distance, lens, tool, answer.normal)) <= 1e-10
    cold = so.distance(names["tracker"].a, names["tracker"].b, names["rest"], pose)
    assert answer.distance == pytest.approx(cold.distance, abs=1e-10)


def test_the_answer_of_the_pair_is_the_minimum_distance() -> None:
    """Of a ring and an ellipsoid: the least way from the ring's circle to the ellipsoid, less the
    tube's radius, over many points of the circle."""
    names, _ = run(PAIR)
    answer, pose = names["answer"], names["pose"]
    turns = np.linspace(0.0, 2.0 * np.pi, 2001)
    circle = np.column_stack([2.0 * np.cos(turns), 2.0 * np.sin(turns), 0.0 * turns])
    least = min(
        so.distance(so.shapes.point(), names["egg"], so.Pose(np.eye(3), p), pose).distance
        for p in circle
    )
    assert answer.certified
    assert answer.distance == pytest.approx(least - 0.5, abs=1e-5)
    assert answer.lower_bound <= least - 0.5


def test_the_gaps_of_the_assembly_are_those_of_its_drawing() -> None:
    """`examples/cad/make_bearing.py` has the lengths; the gaps are closed forms of them."""
    rows = re.findall(r"^ APART +(\w+) +([\d.]+) .*\n +(\w+) ", shown()[ASSEMBLY][2], re.MULTILINE)
    leans = 12.4 * 0.02 + 0.9
    drawn = {
        ("shaft", "seal"): 1.43 - leans,
        ("shaft", "housing"): 10.45 - 10.0 - math.hypot(0.06, 0.08),
        ("housing", "seal"): 3.0 - 1.43 - leans,
    }
    assert {(a, b): float(told) for a, told, b in rows} == pytest.approx(drawn)


def test_every_local_link_of_the_documents_leads_somewhere() -> None:
    pages = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").rglob("*.md")]
    assert (ROOT / "docs" / "index.md") in pages
    missing = [
        f"{page.relative_to(ROOT)}: {target}"
        for page in pages
        for target in LINK.findall(page.read_text(encoding="utf-8"))
        if "://" not in target and not (page.parent / target).exists()
    ]
    assert not missing


def test_its_pictures_lead_to_its_own_headings() -> None:
    anchors = {re.sub(r"[^\w -]", "", x).lower().replace(" ", "-") for x in HEADING.findall(README)}
    inner = re.findall(r"\]\(#([^)]*)\)", README)
    assert len(inner) == len(shown())
    assert set(inner) <= anchors


def test_what_users_look_for_comes_before_the_derivations() -> None:
    links = LINK.findall(README)
    first = min(links.index(f"docs/{page}.md") for page in DERIVED)
    late = [page for page in SOUGHT if f"docs/{page}.md" not in links[:first]]
    assert not late


@pytest.mark.parametrize("page", FRONT)
def test_no_front_page_says_what_the_library_was(page: str) -> None:
    text = " ".join((ROOT / page).read_text(encoding="utf-8").lower().split())
    assert not [words for words in OUTDATED if words in text]


def test_the_extras_that_it_names_exist() -> None:
    project = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    named = {name for group in re.findall(r'"\.\[([\w,]+)\]"', README) for name in group.split(",")}
    assert len(named) > 8
    assert not [name for name in named if not re.search(rf"^{name} = \[$", project, re.MULTILINE)]


@pytest.mark.parametrize(("use", "why"), HALVES)
def test_use_and_proof_are_two_pages_that_link_each_other(use: str, why: str) -> None:
    for page, other in ((use, why), (why, use)):
        opening = (ROOT / "docs" / f"{page}.md").read_text("utf-8").split("\n## ")[0]
        assert f"{other}.md" in LINK.findall(opening), page
