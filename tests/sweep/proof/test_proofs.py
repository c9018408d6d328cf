"""Proofs in folders: the same bytes however they are run; what is refused."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from standoff.errors import StandoffError
from standoff.scene import SceneError
from standoff.sweep import cluster as clusters
from standoff.sweep.folder import FolderError, shard_file
from standoff.sweep.proof.estimate import estimated_proof
from standoff.sweep.proof.proof import Proof
from standoff.sweep.proof.search import search
from standoff.sweep.proof.summary import Kind
from standoff.sweep.run import run_proof, run_sweep
from sweep.conftest import JOB, TOP, Make
from sweep.proof.test_search import BOX
from sweep.test_runs import contents, killed_after_a_while, started

PROVE = f"""{BOX}
[keep]
worst = 30
[prove]
finest = 0.4
queries = 6000
shards = 32
"""

RUN = """
import sys
from pathlib import Path
from standoff.sweep.proof.proof import Proof
from standoff.sweep.reading import load_job
from standoff.sweep.run import run_proof
if __name__ == "__main__":
    run_proof(Proof(load_job(sys.argv[1]), 0.3), Path(sys.argv[2]), workers=int(sys.argv[3]))
"""


def test_the_same_bytes_by_two_processes_and_after_kills(make: Make, tmp_path: Path) -> None:
    proof, told = Proof(make(PROVE), 0.3), []
    one, two = tmp_path / "one", tmp_path / "two"
    report = run_proof(proof, one, progress=lambda done, total: told.append((done, total)))
    assert told == [(k, 32) for k in range(33)]
    script = tmp_path / "run_it.py"
    script.write_text(RUN, encoding="utf-8")
    killed_after_a_while(started(script, proof.job, two, 1), two, 0.05, "shards/*.json")
    assert 0 < len(list(two.glob("shards/*.json"))) < 32
    run_proof(proof, two, workers=2)
    assert contents(one) == contents(two)
    facts = json.loads((one / "report.json").read_text())
    assert facts["verdict"] == report.found.verdict.name == "VIOLATED"
    assert sum(facts["shares"].values()) == pytest.approx(1.0)
    assert facts["queries"] <= 6000
    places = facts["counterexamples"]
    assert len(places["distance"]) == 30 < places["count"]
    assert places["parameters"]["x"][0] == report.found.counterexamples.places.numbers[0, 0]
    assert facts["nearest"]["distance"][0] == places["distance"][0] < 0.3


def test_a_part_is_the_same_by_its_token(make: Make) -> None:
    """As a worker on another machine has it."""
    proof = Proof(make(PROVE), 0.3)
    token, code = proof.token, clusters.digest_of(clusters.code_facts())
    k, text = clusters.shard_text(token, code, 5)
    assert k == 5
    assert clusters.work_of(token).digest == proof.digest
    assert text == clusters.text_of_shard(proof, code, 5, proof.computed(5))


def test_parts_fill_the_box(make: Make) -> None:
    proof = Proof(make(PROVE), 0.3)
    cells = [proof.first(k) for k in range(32)]
    assert {cell.levels.tolist()[0] for cell in cells} == {5}
    assert len({tuple(cell.place[0]) for cell in cells}) == 32


def test_another_clearance_and_a_sweep_are_other_work(make: Make, tmp_path: Path) -> None:
    job = make(PROVE.replace("6000", "200"))
    run_proof(Proof(job, 0.3), tmp_path / "out")
    with pytest.raises(FolderError, match=r"prove\.clearance was 0\.3 and is 0\.4"):
        run_proof(Proof(job, 0.4), tmp_path / "out")
    with pytest.raises(FolderError, match="was begun by another job: "):
        run_sweep(job, tmp_path / "out")
    file, told = shard_file(tmp_path / "out", 3), []
    before = contents(tmp_path / "out")
    file.write_bytes(file.read_bytes().replace(b'"queries": ', b'"queries": 1'))
    run_proof(Proof(job, 0.3), tmp_path / "out", tell=told.append)
    assert "its content is not what its checksum says" in told[0]
    assert contents(tmp_path / "out") == before


def test_the_estimate_tells_shares_and_time(make: Make) -> None:
    proof = Proof(make(PROVE), 0.3)
    found = estimated_proof(proof, workers=2)
    assert found.tried <= 6000
    assert 0.0 < found.violated < found.proven < 1.0
    assert found.seconds > 0.0


def test_the_default_of_finest_is_a_part_of_all_motion(make: Make) -> None:
    proof = Proof(make(PROVE.replace("finest = 0.4\n", "")), 0.3)
    assert proof.box.finest == pytest.approx(1e-3 * proof.box.moves(proof.box.whole)[0][0])


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (JOB, r"parameters\.any: a proof halves ranges, and a uniform rotation has none"),
        (
            f'{TOP}[parameters.x]\nmoves = "tool"\nwhat = "x"\n'
            '[sampler]\nkind = "file"\nfile = "rows.csv"\n',
            "a sampler of kind 'file' has none",
        ),
    ],
)
def test_what_has_no_ranges_is_refused(make: Make, tmp_path: Path, text: str, told: str) -> None:
    (tmp_path / "rows.csv").write_text("x\n1.0\n2.0\n")
    with pytest.raises(StandoffError, match=told):
        Proof(make(text), 0.3)


def test_a_half_space_is_not_turned(make: Make) -> None:
    scene = """version = 1
[bodies.tool]
shape = "sphere"
radius = 1.0
[bodies.part]
shape = "halfspace"
[pair]
a = "tool"
b = "part"
"""
    with pytest.raises(StandoffError, match="'part' is a half-space, and a turn moves its points"):
        Proof(make(BOX, scene), 0.3)
    still = BOX.replace('moves = "part"', 'moves = "tool"')
    box = Proof(make(still, scene), 0.3).box
    box.finest = 1e-4
    found = search(box, box.whole, 10_000, 5)
    # the ball keeps the clearance where it is 1.3 up or more, of the range from -5 to 2
    assert float(found.share(Kind.PROVEN)) == pytest.approx(0.1, abs=1e-3)
    assert float(found.share(Kind.VIOLATED)) == pytest.approx(0.9, abs=1e-3)


@pytest.mark.parametrize(
    ("table", "told"),
    [
        ("shards = 12", "must be a power of two"),
        ("finest = 0.0", "finest"),
        ("queries = -1", "queries"),
        ("cells = 3", "cells"),
    ],
)
def test_tables_that_are_refused(make: Make, table: str, told: str) -> None:
    with pytest.raises(SceneError, match=told):
        make(f"{BOX}\n[prove]\n{table}\n")


def test_what_is_no_proof_or_no_length_is_refused(make: Make, tmp_path: Path) -> None:
    job = make(PROVE)
    with pytest.raises(TypeError, match=r"proof is .*: give Proof\(job, clearance\)"):
        run_proof(job, tmp_path / "out")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="clearance"):
        Proof(job, -1.0)
    with pytest.raises(TypeError, match="load_job"):
        Proof("job.toml", 1.0)  # type: ignore[arg-type]
