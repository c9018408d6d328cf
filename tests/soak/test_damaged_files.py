"""Ledgers and failures' files that are valid JSON but no longer what was written are refused in one
line, with exit code 2."""

import copy
import json
from pathlib import Path

import pytest

from standoff.cli import main
from standoff_studies.soak.cases import draw_case
from standoff_studies.soak.checks import Fault
from standoff_studies.soak.failures import exception_facts, failure_facts
from standoff_studies.soak.running import Failure

SEED, FRAMES, PAIRS = 5, 30, 3
MISSING = object()


@pytest.fixture
def refused(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("STANDOFF_QUIET", "1")

    def run(*arguments: object) -> str:
        capsys.readouterr()
        code = main(["soak", *(str(argument) for argument in arguments)])
        out, err = capsys.readouterr()
        assert (code, out) == (2, ""), (out, err)
        assert err.count("\n") == 1
        return err

    return run


def changed(facts: dict, place: str, value: object) -> dict:
    """A copy with one entry, such as "case.a.kind", changed or gone."""
    copied = copy.deepcopy(facts)
    *path, last = place.split(".")
    inner = copied
    for name in path:
        inner = inner[name]
    if value is MISSING:
        del inner[last]
    else:
        inner[last] = value
    return copied


@pytest.fixture(scope="module")
def ledger(tmp_path_factory) -> tuple[Path, dict]:
    folder = tmp_path_factory.mktemp("soak")
    numbers = ["--pairs", str(PAIRS), "--seed", str(SEED), "--frames", str(FRAMES)]
    assert main(["soak", *numbers, "--jobs", "1", "-o", str(folder)]) == 0
    return folder, json.loads((folder / "soak.json").read_text())


@pytest.mark.parametrize(
    ("place", "value"),
    [
        ("sums", {"x": "y"}),
        ("sums", MISSING),
        ("sums.certified", "abc"),
        ("sums.certified", 1),
        ("sums.certified", -1),
        ("sums.frames", 10),
        ("sums.pairs", 4),
        ("sums.pairs", 3.0),
        ("sums.restarted", 10**6),
        ("sums", {}),
        ("worst", [1.0]),
        ("worst.x", None),
        ("examples", [[1, 2]]),
        ("examples", [["x", 0, "LOCAL", "box - box", 0.0]]),
        ("examples", 7),
        ("done", [[0, 10]]),
        ("done", [[0, float("inf")]]),
        ("done", [[-5, 3]]),
        ("done", [[0, 2], [1, 3]]),
        ("done", [[3, 0]]),
        ("done", [[0]]),
        ("done", {"0": 3}),
        ("seed", MISSING),
        ("frames", "30"),
    ],
)
def test_damaged_ledgers(refused, ledger, tmp_path, place, value):
    _, facts = ledger
    file = tmp_path / "soak.json"
    file.write_text(json.dumps(changed(facts, place, value)))
    numbers = ["--pairs", PAIRS, "--seed", SEED, "--frames", FRAMES, "--jobs", 1]
    assert str(file) in refused(*numbers, "-o", tmp_path, "--resume")


def test_ten_pairs_without_counts_are_not_ten_pairs(refused, ledger, tmp_path):
    _, facts = ledger
    empty = facts | {"done": [[0, 10]], "sums": {}, "worst": {}}
    (tmp_path / "soak.json").write_text(json.dumps(empty))
    numbers = ["--pairs", 10, "--seed", SEED, "--frames", FRAMES, "--jobs", 1]
    said = refused(*numbers, "-o", tmp_path, "--resume")
    assert "it counts 0 pairs where 10 were done" in said


@pytest.mark.parametrize("text", ["", "7", "[]", "null", "[" * 10**5, '{"seed": NaN}', "\x00"])
def test_files_of_another_kind(refused, tmp_path, text):
    (tmp_path / "soak.json").write_text(text)
    assert "not a ledger" in refused("--pairs", 1, "-o", tmp_path, "--resume")
    assert "soak.json" in refused("--replay", tmp_path / "soak.json")


@pytest.fixture(scope="module")
def failure() -> dict:
    case, *_ = draw_case(SEED, 1, FRAMES)
    return failure_facts(Failure(case, Fault(7, "planted", 1.0, 0.0), cold=False))


@pytest.mark.parametrize(
    ("place", "value"),
    [
        ("kind", "another"),
        ("what", MISSING),
        ("what", ""),
        ("what", 7),
        ("value", None),
        ("allowed", "much"),
        ("cold", 1),
        ("frame", FRAMES),
        ("frame", -1),
        ("frame", True),
        ("case", MISSING),
        ("case", None),
        ("case.seed", -1),
        ("case.number", "x"),
        ("case.frames", "x"),
        ("case.frames", 0),
        ("case.frames", 10**15),
        ("case.extra", 1),
        ("case.a.kind", "banana"),
        ("case.a.kind", []),
        ("case.a.numbers", None),
        ("case.a.numbers", {"banana": 1.0}),
        ("case.a", "box"),
        ("case.motion", {}),
        ("case.motion.step", 0.0),
        ("case.motion.step", "x"),
        ("case.motion.uneven", 5.0),
        ("case.motion.jumps", [[1]]),
        ("case.motion.a.start", [1.0]),
        ("case.motion.a.centre", [1.0, float("nan"), 0.0]),
        ("case.motion.a.centre", ["x", 0.0, 0.0]),
        ("case.options", {"predictor": "zzz"}),
        ("case.options", {"zzz": 1}),
        ("case.options", []),
        ("step", {}),
        ("step", 7),
        ("step.state", "x"),
        ("step.poses_a", [0.0] * 12),
        ("step.poses_b", [0.0] * 11),
        ("step.twists_a", [None] * 6),
        ("step.step", MISSING),
    ],
)
def test_damaged_failures(refused, failure, tmp_path, place, value):
    file = tmp_path / "failure.json"
    file.write_text(json.dumps(changed(failure, place, value)))
    assert str(file) in refused("--replay", file)


@pytest.mark.parametrize(
    ("place", "value"),
    [("seed", MISSING), ("seed", -1), ("number", -1), ("number", 1.5), ("frames", 0)],
)
def test_damaged_exceptions(refused, tmp_path, place, value):
    file = tmp_path / "failure.json"
    file.write_text(json.dumps(changed(exception_facts(SEED, 1, FRAMES, "died"), place, value)))
    wrong = "is missing" if value == MISSING else f"= {value}: must be a whole number"
    assert f"'{place}' {wrong}" in refused("--replay", file)


def test_the_whole_files_are_read(failure, ledger, tmp_path, capsys):
    file = tmp_path / "failure.json"
    for facts in (
        failure,
        exception_facts(SEED, 1, FRAMES, "died"),
        changed(failure, "step", None),
    ):
        file.write_text(json.dumps(facts))
        assert main(["soak", "--replay", str(file)]) == 0
    folder, _ = ledger
    numbers = ["--pairs", "4", "--seed", str(SEED), "--frames", str(FRAMES), "--jobs", "1"]
    assert main(["soak", *numbers, "-o", str(folder), "--resume"]) == 0
