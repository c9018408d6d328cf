"""`standoff sweep --prove`: what it prints, its exit codes, and what is refused."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from cli.conftest import Standoff, lines_of
from sweep.conftest import JOB, TOP
from sweep.proof.test_proofs import PROVE


@pytest.fixture
def job(job: Path) -> Path:
    job.write_text(PROVE, encoding="utf-8")
    return job


def test_a_box_that_is_not_kept(standoff: Standoff, job: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    ended = standoff("sweep", job, "--prove", "clearance=0.3", "-o", out)
    assert ended.code == 3
    facts, said = json.loads((out / "report.json").read_text()), lines_of(ended.out)
    assert said["prove"] == "Two ellipsoids: tool and part, clearance 0.3 cm"
    assert said["parameters"].startswith("x (x of tool), z (z of tool), ")
    assert said["verdict"].startswith("VIOLATED: ")
    share, cells = facts["shares"]["PROVEN"], facts["number"]["PROVEN"]
    assert said["proven"] == f"{100.0 * share:.6g} % of the box, {cells} cells"
    assert said["nearer"].startswith(f"{facts['nearest']['distance'][0]:.6g} cm at x ")
    assert said["wrote"] == str(out / "report.json")
    again = standoff("sweep", job, "--prove", "clearance=0.3", "-o", out, "--json")
    short = json.loads(again.out)
    assert short["shares"] == facts["shares"]
    assert len(short["counterexamples"]["distance"]) == 10


def test_a_box_that_is_kept(standoff: Standoff, job: Path, tmp_path: Path) -> None:
    job.write_text(PROVE.replace("from = -5.0\nto = 2.0", "from = 0.5\nto = 2.0"))
    ended = standoff("sweep", job, "--prove", "clearance=0.5", "-o", tmp_path / "out")
    said = lines_of(ended.out)
    assert ended.code == 0
    assert said["verdict"] == "PROVEN: the clearance is kept everywhere in the box"
    assert said["proven"].startswith("100 % of the box")
    assert "proven" in said["bound"]
    assert "nearer" not in said
    assert "open" in said


def test_a_box_that_is_open_says_where(standoff: Standoff, job: Path, tmp_path: Path) -> None:
    text = PROVE.replace("from = -5.0\nto = 2.0", "from = 0.5\nto = 2.0")
    job.write_text(text.replace("queries = 6000", "queries = 16"))
    ended = standoff("sweep", job, "--prove", "clearance=0.5", "-o", tmp_path / "out")
    said = lines_of(ended.out)
    assert ended.code == 3
    assert said["verdict"].startswith("UNDECIDED: neither is proven")


def test_the_estimate(standoff: Standoff, job: Path, tmp_path: Path) -> None:
    before = sorted(tmp_path.iterdir())
    ended = standoff("sweep", job, "--prove", "clearance=0.3", "--estimate")
    said = lines_of(ended.out)
    assert ended.code == 0
    assert said["shards"] == "32"
    assert said["time"].startswith("at most ")
    assert said["after these"].endswith("of the box")
    told = json.loads(
        standoff("sweep", job, "--prove", "clearance=0.3", "--estimate", "--json").out
    )
    assert told["queries"] == 6000
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize(
    ("given", "told"),
    [
        (["--prove", "0.3", "-o", "out"], "--prove: give the length that is to be kept"),
        (["--prove", "clearance=x", "-o", "out"], "got 'clearance=x'"),
        (["--prove", "clearance=nan", "-o", "out"], "a length is zero or above"),
        (["--prove", "clearance=-1", "-o", "out"], "a length is zero or above"),
        (["--prove", "clearance=1", "--row", "3"], "--row and --prove"),
        (["--prove", "clearance=1", "-o", "out", "--plot", "a.png"], "--plot: draws the histogram"),
        (["--prove", "clearance=1", "-o", "out", "--page", "a.html"], "--page: "),
        (["--prove", "clearance=1"], "-o: name the folder"),
    ],
)
def test_options_that_are_refused(
    standoff: Standoff,
    job: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    given: list[str],
    told: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    before = sorted(tmp_path.iterdir())
    ended = standoff("sweep", job, *given)
    assert (ended.code, ended.out) == (2, "")
    assert told in ended.err
    assert sorted(tmp_path.iterdir()) == before


def test_a_job_without_ranges(standoff: Standoff, job: Path, tmp_path: Path) -> None:
    assert TOP in JOB
    job.write_text(JOB, encoding="utf-8")
    ended = standoff("sweep", job, "--prove", "clearance=1", "-o", tmp_path / "out")
    assert ended.code == 2
    assert "parameters.any: a proof halves ranges" in ended.err
    assert not (tmp_path / "out").exists()
