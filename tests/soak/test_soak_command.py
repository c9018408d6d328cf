"""``standoff soak``: a planted fault is found and replayed, a stopped run goes on, and the counts
depend on the seed alone."""

import json
import subprocess
import sys
import time
from pathlib import Path

import pytest

from standoff.cli import main
from standoff_studies import oracles
from standoff_studies.soak import processes
from standoff_studies.soak.cases import Case
from standoff_studies.soak.checks import Fault
from standoff_studies.soak.failures import failure_facts, replay
from standoff_studies.soak.running import Failure

SEED = 5
FRAMES = 12
COMMON = ["--seed", SEED, "--frames", FRAMES]


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]):
    def soak(*arguments: object) -> tuple[int, str, str]:
        capsys.readouterr()
        code = main(["soak", *(str(argument) for argument in arguments)])
        return (code, *capsys.readouterr())

    return soak


def ledger(folder: Path) -> dict:
    return json.loads((folder / "soak.json").read_text())


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> dict:
    """The ledger of 70 pairs in one process."""
    folder = tmp_path_factory.mktemp("whole")
    arguments = ["--pairs", 70, *COMMON, "--jobs", 1, "-o", folder]
    assert main(["soak", *map(str, arguments)]) == 0
    return ledger(folder)


@pytest.fixture
def planted(monkeypatch):
    """The judge takes ellipsoids for a little larger than they are."""
    true = oracles.Ellipsoid.points
    monkeypatch.setattr(oracles.Ellipsoid, "points", lambda self, n: 1.000001 * true(self, n))


def test_a_planted_fault_is_found_and_replayed(run, tmp_path, planted, monkeypatch):
    code, _, err = run("--pairs", 64, *COMMON, "--jobs", 1, "-o", tmp_path)
    assert code == 3
    (file,) = tmp_path.glob("failure-*.json")
    assert str(file) in err
    facts = json.loads(file.read_text())
    kinds = facts["case"]["a"]["kind"], facts["case"]["b"]["kind"]
    assert any("ellipsoid" in kind for kind in kinds)
    assert len(facts["step"]["poses_a"]) == 12
    code, out, _ = run("--replay", file)
    assert code == 3
    assert f"frame {facts['frame']}: {facts['what']}" in out.splitlines()[1]
    # a step that has a state before it is replayed by itself, too
    later = failure_facts(Failure(Case.of(facts["case"]), Fault(7, "", 1.0, 0.0), cold=False))
    step = replay(json.loads(json.dumps(later))).step
    assert step is not None
    assert step.frame == 7
    # without the fault the pair passes, and the soak goes on from where it was
    monkeypatch.undo()
    code, out, _ = run("--replay", file)
    assert code == 0
    assert "no check of the pair fails" in out
    code, _, _ = run("--pairs", 64, *COMMON, "--jobs", 1, "-o", tmp_path, "--resume")
    assert code == 0
    assert ledger(tmp_path)["sums"]["pairs"] == 64


def test_counts_depend_on_the_seed_alone(run, tmp_path, whole):
    assert run("--pairs", 70, *COMMON, "--jobs", 2, "-o", tmp_path / "2")[0] == 0
    assert whole == ledger(tmp_path / "2")
    other = ["--pairs", 5, "--seed", SEED + 1, "--frames", FRAMES, "--jobs", 1]
    assert run(*other, "-o", tmp_path / "3")[0] == 0
    assert whole["worst"] != ledger(tmp_path / "3")["worst"]


def test_a_stopped_run_goes_on_to_the_same_counts(run, tmp_path, monkeypatch, whole):
    stopped = tmp_path / "stopped"
    true = processes.run_part

    def interrupted(seed, frames, part, *rest):
        if part[0] >= 64:
            raise KeyboardInterrupt
        return true(seed, frames, part, *rest)

    arguments = ["--pairs", 70, *COMMON, "--jobs", 1, "-o", stopped]
    monkeypatch.setattr(processes, "run_part", interrupted)
    code, _, err = run(*arguments)
    assert code == 130
    assert "interrupted at 64 pairs" in err
    monkeypatch.undo()
    code, _, err = run(*arguments)
    assert code == 2
    assert "--resume" in err
    assert run(*arguments, "--resume")[0] == 0
    assert ledger(stopped) == whole
    # done already: nothing more to do
    assert run(*arguments, "--resume")[0] == 0
    assert ledger(stopped) == whole


def test_a_pair_that_hangs_or_kills_its_process_fails(run, tmp_path, monkeypatch):
    arguments = ["--pairs", 2, *COMMON, "--jobs", 2]
    monkeypatch.setattr(processes, "PATIENCE", 0.0)
    monkeypatch.setattr(processes, "LOOK", 0.01)
    code, _, err = run(*arguments, "-o", tmp_path / "hang")
    assert code == 3
    assert "the pair hangs" in err
    monkeypatch.undo()
    true = processes._Worker.give

    def killed(self, part):
        true(self, part)
        self.process.kill()

    monkeypatch.setattr(processes._Worker, "give", killed)
    code, _, err = run(*arguments, "-o", tmp_path / "death")
    assert code == 3
    assert "the process died" in err
    monkeypatch.undo()
    # such a failure has no answers: replaying it runs the pair
    assert run("--replay", tmp_path / "death" / "failure-0.json")[0] == 0


def test_the_clock_of_a_pair_begins_when_the_kernels_are_there(monkeypatch):
    monkeypatch.setattr(processes, "PATIENCE", 0.0)
    worker = processes._Worker(SEED, 30)
    try:
        worker.give((0, 1))
        time.sleep(0.01)
        assert not worker.hangs()
        monkeypatch.setattr(processes, "PREPARATION", 0.0)
        assert worker.hangs()
        assert worker.hear() is None
        time.sleep(0.01)
        assert worker.hangs()
        monkeypatch.setattr(processes, "PATIENCE", 300.0)
        assert not worker.hangs()
        done = worker.hear()
        assert done is not None
        assert done.tally.sums["frames"] == 30
    finally:
        worker.end()


PREPARED = f"""
import gc
from numba.core.dispatcher import Dispatcher
from standoff_studies.soak.preparing import compile_kernels
from standoff_studies.soak.processes import run_part

def entered():
    kernels = [one for one in gc.get_objects() if isinstance(one, Dispatcher)]
    return {{one.__name__: list(one.overloads) for one in kernels if one.overloads}}

compile_kernels()
before = entered()
assert run_part({SEED}, 5, (0, 128)).facts is None
print(len(before), before == entered())
"""


def test_no_pair_compiles_a_kernel():
    ran = subprocess.run(
        [sys.executable, "-c", PREPARED], capture_output=True, text=True, check=True
    )
    count, same = ran.stdout.split()
    assert int(count) > 3
    assert same == "True"


ORPHAN = f"""
import time
from standoff_studies.soak.processes import _Worker

worker = _Worker({SEED}, 2000)
worker.give((0, 10**9))
worker.hear()
print("ready", flush=True)
time.sleep(1e6)
"""


def test_workers_end_with_their_parent(tmp_path):
    """They hold the parent's stdout, which ends with the last of them."""
    script = [sys.executable, "-c", ORPHAN]
    with subprocess.Popen(script, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as parent:
        assert parent.stdout is not None
        assert parent.stdout.readline() == b"ready\n"
        parent.kill()
        out, err = parent.communicate(timeout=60.0)
    assert (out, err) == (b"", b"")


def test_a_folder_that_cannot_be_written_is_refused_first(run, tmp_path, monkeypatch):
    def refuse(**_):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("tempfile.TemporaryFile", refuse)
    monkeypatch.setattr("standoff_studies.soak.command.soak", lambda *_: pytest.fail("it began"))
    code, _, err = run("--pairs", 1, *COMMON, "-o", tmp_path)
    assert code == 2
    assert f"{tmp_path} cannot be written (Permission denied)" in err


def test_an_exception_is_a_failure(run, tmp_path, monkeypatch):
    def broken(made, poses, points, n):
        raise ZeroDivisionError("planted")

    monkeypatch.setattr("standoff_studies.soak.checks.outside", broken)
    code, _, err = run("--pairs", 64, *COMMON, "--jobs", 1, "-o", tmp_path)
    assert code == 3
    assert "ZeroDivisionError: planted" in err


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--pairs", 0], "--pairs 0"),
        (["--frames", 0], "--frames 0"),
        (["--jobs", 0], "--jobs 0"),
        (["--seed", -1], "--seed -1"),
        (["--replay", "nowhere.json"], "nowhere.json"),
    ],
)
def test_bad_numbers_are_refused(run, tmp_path, monkeypatch, arguments, said):
    monkeypatch.chdir(tmp_path)
    code, _, err = run(*arguments)
    assert code == 2
    assert said in err


def test_foreign_files_are_refused(run, tmp_path):
    file = tmp_path / "other.json"
    file.write_text("{}")
    assert "not a failure of a soak" in run("--replay", file)[2]
    (tmp_path / "soak.json").write_text("{}")
    arguments = ["--pairs", 1, *COMMON, "-o", tmp_path, "--resume"]
    code, _, err = run(*arguments)
    assert code == 2
    assert "not a ledger of a soak" in err
    facts = {"standoff": "0.0", "seed": SEED, "frames": FRAMES, "done": [], "sums": {}, "worst": {}}
    (tmp_path / "soak.json").write_text(json.dumps(facts | {"examples": []}))
    assert "standoff 0.0" in run(*arguments)[2]


@pytest.mark.parametrize("file", sorted(Path(__file__).with_name("mended").glob("*.json")))
def test_what_a_soak_once_found_is_mended(file):
    """The very step, from the state before it: in the whole run roundoff may lead elsewhere."""
    facts = json.loads(file.read_text())
    assert facts["step"]["state"]
    found = replay(facts)
    assert found.step is None
    assert found.failure is None
