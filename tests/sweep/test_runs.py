"""Runs: the same bytes for any number of processes and after any stop; what is refused."""

from __future__ import annotations

import errno
import json
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any, BinaryIO

import pytest

from standoff import whole_files
from standoff.errors import StandoffError
from standoff.sweep import folder as folders
from standoff.sweep import run as runs
from standoff.sweep.estimate import estimated
from standoff.sweep.folder import FolderError, locked, shard_file
from standoff.sweep.job import Job
from standoff.sweep.reading import load_job
from standoff.sweep.run import run_sweep
from sweep.conftest import JOB, SCENE, TOP, Make
from waiting import LONG, happens

MANY = JOB.replace("rows = 700", "rows = 60")
"""50 shards of some milliseconds each."""

RUN = """
import sys
from pathlib import Path
from standoff.sweep.reading import load_job
from standoff.sweep.run import run_sweep
if __name__ == "__main__":
    run_sweep(load_job(sys.argv[1]), Path(sys.argv[2]), workers=int(sys.argv[3]))
"""


def contents(folder: Path) -> dict[str, bytes]:
    return {
        str(file.relative_to(folder)): file.read_bytes()
        for file in sorted(folder.rglob("*"))
        if file.is_file()
    }


@pytest.fixture
def script(tmp_path: Path) -> Path:
    file = tmp_path / "run_it.py"
    file.write_text(RUN, encoding="utf-8")
    return file


def started(script: Path, job: Job, folder: Path, workers: int) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        [sys.executable, str(script), str(job.file), str(folder), str(workers)],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        start_new_session=True,
    )


def killed_after_a_while(
    process: subprocess.Popen[bytes], folder: Path, seconds: float, new: str
) -> None:
    """Kill a run some time after it wrote a new file of a pattern, if it has not ended by then."""
    before = len(list(folder.glob(new)))
    while process.poll() is None and len(list(folder.glob(new))) <= before:
        time.sleep(0.002)
    time.sleep(seconds)
    process.kill()
    process.wait()


def gone(group: int) -> bool:
    """Has every process of a group ended?"""
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return True
    return False


def test_two_processes_write_the_same_bytes(make: Make, tmp_path: Path) -> None:
    job, told = make(), []
    one, two = tmp_path / "one", tmp_path / "two"
    report = run_sweep(job, one, progress=lambda done, total: told.append((done, total)))
    assert told == [(k, 3000) for k in (0, 700, 1400, 2100, 2800, 3000)]
    run_sweep(job, two, workers=2)
    assert len(contents(one)) == 5 + 3
    assert contents(one) == contents(two)
    facts = json.loads((one / "report.json").read_text())
    assert facts["rows"] == 3000
    assert facts["holds"] is report.holds is False
    assert facts["below"]["all_listed"] is False
    row = facts["worst"]["row"][3]
    numbers = [facts["worst"]["parameters"][name][3] for name in job.columns]
    assert numbers == job.numbers(row, row + 1)[0].tolist()
    assert facts["worst"]["distance"][3] == job.distances(row, row + 1).distance[0]


def test_a_run_that_is_done_is_not_done_again(
    make: Make, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    job = make()
    run_sweep(job, tmp_path / "out")
    before = contents(tmp_path / "out")
    monkeypatch.setattr(runs, "make_shard", None)
    run_sweep(job, tmp_path / "out")
    assert contents(tmp_path / "out") == before


@pytest.mark.parametrize(
    ("workers", "kills", "seed"),
    [
        ((1, 2, 1), 3, 3),
        *(pytest.param((1, 2, 3), 10, seed, marks=pytest.mark.soak) for seed in range(10, 20)),
    ],
)
def test_killed_at_any_moment_it_ends_with_the_same_bytes(
    make: Make, tmp_path: Path, script: Path, workers: tuple[int, ...], kills: int, seed: int
) -> None:
    job = make(MANY)
    run_sweep(job, tmp_path / "whole")
    rng, folder, early = random.Random(seed), tmp_path / "out", 0
    folder.mkdir()
    for k in range(kills):
        process = started(script, job, folder, workers[k % len(workers)])
        # The first may be killed before it has a shard, the others while all workers are busy.
        new = "shards/0*.json" if k else "*"
        killed_after_a_while(process, folder, rng.uniform(0.0, 0.15), new)
        early += not (folder / "report.json").exists()
        if (folder / "report.json").exists():  # it was done: some of it is to be done again
            for number in rng.sample(range(job.shards), 40):
                shard_file(folder, number).unlink()
            (folder / "report.json").unlink()
        if not happens(lambda process=process: gone(process.pid), LONG):
            os.killpg(process.pid, signal.SIGKILL)
            pytest.fail("workers outlive the process that was killed")
    assert early > 0
    told: list[str] = []
    run_sweep(job, folder, tell=told.append)
    assert told == []  # what is there is whole
    assert contents(folder) == contents(tmp_path / "whole")


def test_what_a_killed_process_left_is_removed(make: Make, tmp_path: Path) -> None:
    job = make()
    run_sweep(job, tmp_path / "whole")
    (tmp_path / "out" / "shards").mkdir(parents=True)
    (tmp_path / "out" / ".0123.part").touch()
    (tmp_path / "out" / "shards" / ".4567.part").touch()
    with pytest.raises(FolderError, match="holds shards and no sweep"):
        run_sweep(job, tmp_path / "out")
    (tmp_path / "out" / "manifest.json").write_bytes(
        (tmp_path / "whole" / "manifest.json").read_bytes()
    )
    run_sweep(job, tmp_path / "out")
    assert contents(tmp_path / "out") == contents(tmp_path / "whole")


def test_damaged_shards_are_told_and_computed_again(make: Make, tmp_path: Path) -> None:
    job, folder, told = make(), tmp_path / "out", list[str]()
    run_sweep(job, folder)
    before = contents(folder)
    text = shard_file(folder, 1).read_bytes()
    shard_file(folder, 1).write_bytes(text[:100])
    shard_file(folder, 2).write_bytes(shard_file(folder, 3).read_bytes())
    shard_file(folder, 3).unlink()
    (folder / "report.json").unlink()
    run_sweep(job, folder, tell=told.append)
    assert len(told) == 2
    assert "000000001.json cannot be used, it is not a whole file: it is computed again" in told[0]
    assert "000000002.json cannot be used, its shard is 3, not 2: it is computed" in told[1]
    assert contents(folder) == before


def test_a_shard_that_is_changed_while_the_sweep_runs(
    make: Make, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    job, folder = make(), tmp_path / "out"
    run_sweep(job, folder)
    monkeypatch.setattr(runs, "missing_shards", lambda *_: [])
    shard_file(folder, 1).write_text("{}")
    with pytest.raises(StandoffError, match=r"000000001\.json was changed: it is not a whole file"):
        run_sweep(job, folder)
    shard_file(folder, 1).unlink()
    with pytest.raises(StandoffError, match=r"000000001\.json was removed: run it again"):
        run_sweep(job, folder)


def test_another_job_is_refused_and_what_differs_is_named(make: Make, tmp_path: Path) -> None:
    folder = tmp_path / "out"
    run_sweep(make(), folder)
    before = contents(folder)
    for old, new, told in (
        ("seed = 5", "seed = 6", "sampler.seed was 5 and is 6"),
        ("to = 5.0", "to = 5.5", "parameters.x.to was 5.0 and is 5.5"),
        ("below = 0.5\nmost_below = 100", "", "keep.below was 0.5 and is missing"),
        (TOP, f"{TOP}within = 9.0\n", "within was missing and is 9.0"),
    ):
        with pytest.raises(FolderError, match="was begun by another job: ") as caught:
            run_sweep(make(JOB.replace(old, new)), folder)
        assert told in str(caught.value)
    with pytest.raises(FolderError, match=r"bodies\.a_sha256 was"):
        run_sweep(make(scene=SCENE.replace("3.0, 1.0", "3.0, 1.1")), folder)
    with pytest.raises(FolderError, match=r"poses\.a was"):
        run_sweep(make(scene=SCENE.replace("7.0]", "7.1]")), folder)
    assert contents(folder) == before
    assert run_sweep(make(f"# another comment\n{JOB}"), folder).found.rows == 3000


def test_arguments_that_are_refused(make: Make, tmp_path: Path) -> None:
    job: Any = make()
    for workers in (0, -1, 1.5, True, "2", None):
        with pytest.raises((TypeError, ValueError), match="workers"):
            run_sweep(job, tmp_path / "out", workers=workers)  # type: ignore[arg-type]
        with pytest.raises((TypeError, ValueError), match="workers"):
            estimated(job, workers)  # type: ignore[arg-type]
    for wrong in (None, 3, "job.toml"):
        with pytest.raises(TypeError, match="give what load_job returns"):
            run_sweep(wrong, tmp_path / "out")  # type: ignore[arg-type]
        with pytest.raises(TypeError, match="give what load_job returns"):
            estimated(wrong, 1)  # type: ignore[arg-type]
    for folder in (None, 3, ""):
        with pytest.raises((TypeError, ValueError), match="path"):
            run_sweep(job, folder)  # type: ignore[arg-type]
    for file in (None, 3, b"job.toml"):
        with pytest.raises(TypeError, match="path is"):
            load_job(file)  # type: ignore[arg-type]
    assert not (tmp_path / "out").exists()


def test_another_library_is_refused(
    make: Make, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run_sweep(make(), tmp_path / "out")
    code = folders.code_facts() | {"numpy": "9.9"}
    monkeypatch.setattr(folders, "code_facts", lambda: code)
    with pytest.raises(FolderError, match=r"another library: numpy was \S+ and is \"9.9\""):
        run_sweep(make(), tmp_path / "out")


def test_folders_of_something_else_are_refused(make: Make, tmp_path: Path) -> None:
    job, folder = make(), tmp_path / "out"
    folder.mkdir()
    (folder / "thesis.tex").touch()
    with pytest.raises(FolderError, match=r"holds thesis\.tex and no sweep"):
        run_sweep(job, folder)
    assert list(contents(folder)) == ["thesis.tex"]
    for text in ("", "[]", "{}", '{"format": "x"}'):
        (folder / "manifest.json").write_text(text)
        with pytest.raises(FolderError, match="is not a manifest of a sweep"):
            run_sweep(job, folder)
    assert sorted(file.name for file in folder.iterdir()) == [
        ".lock",
        "manifest.json",
        "thesis.tex",
    ]


def test_a_second_run_in_the_same_folder_is_refused(make: Make, tmp_path: Path) -> None:
    job, folder = make(), tmp_path / "out"
    folder.mkdir()
    with locked(folder), pytest.raises(FolderError, match="another sweep runs in this folder"):
        run_sweep(job, folder)
    assert sorted(file.name for file in folder.iterdir()) == [".lock"]
    run_sweep(job, folder)  # the lock has ended with who held it


def test_a_full_disk(make: Make, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The disk is full in the middle of the third file: nothing of it stays."""
    job, folder = make(), tmp_path / "out"
    run_sweep(job, tmp_path / "whole")
    real, written = whole_files.write_whole, list[Path]()

    def full(files: dict[Path, whole_files.Writer]) -> None:
        (target,) = files
        written.append(target)

        def half(stream: BinaryIO) -> None:
            stream.write(b"{")
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

        real({target: half} if len(written) == 3 else files)

    monkeypatch.setattr(folders, "write_whole", full)
    with pytest.raises(OSError, match="No space left on device"):
        run_sweep(job, folder)
    assert list(contents(folder)) == [".lock", "manifest.json", "shards/000000000.json"]
    run_sweep(job, folder)
    assert contents(folder) == contents(tmp_path / "whole")


def test_an_interrupt_leaves_whole_shards(make: Make, tmp_path: Path) -> None:
    job, folder = make(), tmp_path / "out"

    def interrupted(done: int, total: int) -> None:
        if done == 1400:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_sweep(job, folder, progress=interrupted)
    assert folders.missing_shards(job, folder, pytest.fail) == [2, 3, 4]


@pytest.mark.soak
def test_an_interrupt_of_a_terminal_ends_all_processes(
    make: Make, tmp_path: Path, script: Path
) -> None:
    job, folder = make(MANY.replace("rows = 3000", "rows = 60000")), tmp_path / "out"
    process = started(script, job, folder, 2)
    while not list(folder.glob("shards/0*.json")):
        assert process.poll() is None, process.communicate()[0]
        time.sleep(0.01)
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to all of them
    said = process.communicate(timeout=LONG)[0]
    assert b"KeyboardInterrupt" in said
    assert process.returncode != 0
    missing = folders.missing_shards(job, folder, pytest.fail)
    assert 0 < len(missing) < job.shards
