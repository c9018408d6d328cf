"""The README's example runs as it is printed there, and its answer is right."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import standoff as so
from oracles.bounds import gap
from standoff_studies.oracles import Ellipsoid, Lens, Placed

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
LINK = re.compile(r"\]\(([^)#\s]+)")
# What users look for, and the pages that derive it.
SOUGHT = (
    *("quick-start", "ten-tasks", "coming-from", "derivatives", "differentiable", "many-poses"),
    *("fast-loops", "c-interface", "servo", "live-page", "time-of-impact", "answers"),
)
DERIVED = ("architecture", "symbols", "pair-system", "laws", "automaton", "certificate")
# A page for use, and the page that says how it works and why it is right.
HALVES = (
    ("answers", "options"),
    ("time-of-impact", "impact-proof"),
    ("servo", "servo-loop"),
    ("coupler", "coupler-passivity"),
)


def python_block() -> str:
    blocks = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    assert len(blocks) == 1
    return str(blocks[0])


@pytest.fixture(scope="module")
def example() -> dict[str, Any]:
    names: dict[str, Any] = {}
    exec(compile(python_block(), "README.md", "exec"), names)
    return names


def test_example_prints_what_the_readme_says(capsys: pytest.CaptureFixture[str]) -> None:
    code = python_block()
    exec(compile(code, "README.md", "exec"), {})
    (promised,) = re.findall(r"^# (.*)$", code, re.MULTILINE)
    assert capsys.readouterr().out.strip() == promised


def test_example_has_ten_lines_of_code() -> None:
    lines = [line for line in python_block().splitlines() if line and not line.startswith("#")]
    assert len(lines) == 10


def test_example_answer_is_the_minimum_distance(example: dict[str, Any]) -> None:
    answer, path = example["answer"], example["path"]
    pose = path.pose(1.0)
    lens = Placed(Lens(1.0, 0.45), np.eye(3), np.zeros(3))
    tool = Placed(Ellipsoid(0.15, 0.30, 0.20), pose.rotation, pose.translation)
    assert answer.certified
    assert abs(gap(answer.distance, lens, tool, answer.normal)) <= 1e-10
    cold = so.distance(example["lens"], example["tool"], example["rest"], pose)
    assert answer.distance == pytest.approx(cold.distance, abs=1e-10)


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


def test_what_users_look_for_comes_before_the_derivations() -> None:
    links = LINK.findall(README)
    first = min(links.index(f"docs/{page}.md") for page in DERIVED)
    late = [page for page in SOUGHT if f"docs/{page}.md" not in links[:first]]
    assert not late


def test_it_says_in_one_line_that_step_is_read() -> None:
    assert (
        len(re.findall(r"^Parts and assemblies from CAD .* STEP.*\.$", README, re.MULTILINE)) == 1
    )


@pytest.mark.parametrize(("use", "why"), HALVES)
def test_use_and_proof_are_two_pages_that_link_each_other(use: str, why: str) -> None:
    for page, other in ((use, why), (why, use)):
        opening = (ROOT / "docs" / f"{page}.md").read_text("utf-8").split("\n## ")[0]
        assert f"{other}.md" in LINK.findall(opening), page
