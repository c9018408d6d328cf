"""The table beside other packages: rows, our errors, files, what is missing; no time is judged."""

import sys

import pyarrow.parquet as pq
import pytest
from benchmarks.bench import __main__ as bench
from benchmarks.bench import goals, library, operations
from benchmarks.bench.motion import all_pairs
from benchmarks.bench.race import Effort, raced

OURS = 1e-12
"""Greatest error of a distance of the library, over the size."""
WITNESS = 1e-9
"""That of a witness point: a distance is flat about its least, so a gap of 1e-12 leaves them 1e-6
of a radius in theory; a Newton step, which leaves such a gap, reaches 1e-10."""
TINY = Effort(frames=12, contact_frames=6, rounds=1, budget=1e-3, finest=1e-3)
ALWAYS = ("SciPy SLSQP, warm", *(f"{library.COMPILED}, {law}" for law in library.WARM))


FEW = ("ellipsoids", "box, ellipsoid", "NURBS of degree 3", "boxes in penetration")
"""Pairs of `make test`; `make soak` tries them all."""


def pairs_of(names):
    return [pair for pair in all_pairs() if pair.name in names]


@pytest.fixture(
    scope="module",
    params=[
        pytest.param(FEW, id="few"),
        pytest.param([pair.name for pair in all_pairs()], id="all", marks=pytest.mark.soak),
    ],
)
def written(request, tmp_path_factory, quick_collections):
    """The folder of the files, and the pairs in it."""
    folder = tmp_path_factory.mktemp("bench")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(bench, "QUICK", TINY)
        patch.setattr(bench, "all_pairs", lambda: pairs_of(request.param))
        bench.main(["--quick", "-o", str(folder)])
    return folder, pairs_of(request.param)


def test_files_hold_every_row(written):
    folder, pairs = written
    text = (folder / "bench.md").read_text()
    table = pq.read_table(folder / "bench.parquet").to_pylist()
    assert (folder / "bench.png").read_bytes().startswith(b"\x89PNG")
    for pair in pairs:
        assert f"### {pair.name}\n" in text
        rows = {row["contender"]: row for row in table if row["pair"] == pair.name}
        for name in library.OURS:
            assert rows[name]["distance_error"] < OURS, (pair.name, name)
            assert rows[name]["witness_error"] < WITNESS, (pair.name, name)
            assert rows[name]["seconds"] > 0.0
    names = {row["contender"] for row in table}
    assert set(ALWAYS) <= names
    for goal in goals.GOALS:
        assert f"| {goal.pair}: {goal.work} | {goal.against} |" in text


def test_operations_and_bytes_are_counted(written):
    operations.done.clear()
    x, y = (operations.Numbers([operations.Counted(k) for k in (1.0, 2.0, 3.0)]) for _ in "xy")
    x[1] = x[0] * y[0] + 2.0 * y[1] - x[2] / y[2]
    told = {"products": 2, "sums": 2, "divisions": 1, "reads": 5, "writes": 1}
    assert dict(operations.done) == told
    cost = operations.counted()
    assert cost == operations.counted()
    assert cost.products > 500
    assert f"{cost.products} products" in (written[0] / "bench.md").read_text()


def test_a_missing_peer_is_told(monkeypatch):
    for package in ("coal", "mujoco", "fcl", "OCP"):
        monkeypatch.setitem(sys.modules, package, None)
    rows, _ = raced(all_pairs()[0], TINY)
    missing = {row.contender: row.missing for row in rows if row.missing}
    assert len(missing) >= 5
    for name in ("Coal", "MuJoCo", "python-fcl", "OpenCASCADE"):
        assert "standoff-studies[peers]" in missing[name]
