"""A sweep on a cluster of Dask, where it is installed: the same bytes, and a lost scheduler."""

from __future__ import annotations

import builtins
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from standoff.errors import StandoffError
from standoff.sweep import cluster as clusters
from standoff.sweep.folder import missing_shards
from standoff.sweep.run import run_sweep
from sweep.conftest import JOB, Make
from sweep.test_runs import contents


@pytest.fixture
def local() -> Iterator[Any]:
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=2, dashboard_address=None, protocol="tcp"
    ) as cluster:
        yield cluster


@pytest.mark.soak
def test_the_same_bytes_and_a_scheduler_that_is_lost(
    make: Make, tmp_path: Path, local: Any
) -> None:
    job, told = make(JOB.replace("rows = 700", "rows = 100")), []
    run_sweep(job, tmp_path / "whole")
    address = local.scheduler_address
    run_sweep(job, tmp_path / "out", cluster=address, progress=lambda n, _: told.append(n))
    assert contents(tmp_path / "out") == contents(tmp_path / "whole")
    assert told[-1] == 3000
    assert len(told) == 31

    folder = tmp_path / "lost"

    def lose(done: int, total: int) -> None:
        if done == 500:
            local.close()

    with pytest.raises(OSError, match="failed or was lost"):
        run_sweep(job, folder, cluster=address, progress=lose)
    assert 0 < len(missing_shards(job, folder, pytest.fail)) < 30
    run_sweep(job, folder)
    assert contents(folder) == contents(tmp_path / "whole")


def test_a_worker_with_something_else(make: Make) -> None:
    job = make()
    code = clusters.digest_of(clusters.code_facts())
    token = job.token
    assert clusters.shard_text(token, code, 4)[0] == 4
    with pytest.raises(StandoffError, match="a worker has another library"):
        clusters.shard_text(token, "0" * 64, 4)
    with pytest.raises(StandoffError, match="a worker finds another job in "):
        clusters.shard_text((token[0], "0" * 64, None), code, 4)


def test_without_dask(make: Make, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def none_of_dask(name: str, *given: Any, **named: Any) -> Any:
        if name == "distributed":
            raise ModuleNotFoundError("No module named 'distributed'", name=name)
        return real(name, *given, **named)

    monkeypatch.setattr(builtins, "__import__", none_of_dask)
    with pytest.raises(ModuleNotFoundError, match=r"pip install 'standoff\[cluster\]'"):
        run_sweep(make(), tmp_path / "out", cluster="tcp://127.0.0.1:1")
