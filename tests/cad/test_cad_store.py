"""Finished parts on disk: the same solids without OpenCASCADE, and never another file's."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import cad_shapes as made
import numpy as np
import pytest

import standoff as so
from standoff.cad import instances, reading, store
from standoff.cad.assembly import Assembly
from standoff.errors import CadError, StandoffError

pytest.importorskip("OCP", reason="OpenCASCADE comes with the extra 'cad'")

from standoff.cad.opencascade import compound


@pytest.fixture
def kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of a store that is used."""
    folder = tmp_path / "store"
    monkeypatch.setenv(store.FOLDER, str(folder))
    monkeypatch.setenv(store.SIZE, "100")
    store._refuse.cache_clear()
    store._unkept.cache_clear()
    return folder


@pytest.fixture(scope="module")
def shapes() -> list[Any]:
    """A plate with a hole, a cube in front of it, and the plate once more, moved."""
    from OCP.gp import gp_Trsf, gp_Vec
    from OCP.TopLoc import TopLoc_Location

    plate = made.cut(made.box(20, 20, 5), made.cylinder((10, 10, -1), 4.0, 10))
    away = gp_Trsf()
    away.SetTranslation(gp_Vec(0, 0, 7))
    return [plate, made.box(3, 3, 3, (0, 0, 20)), plate.Moved(TopLoc_Location(away))]


@pytest.fixture
def file(shapes: list[Any], tmp_path: Path) -> Path:
    return made.write_step(compound(shapes), tmp_path / "plates.step")


@pytest.fixture
def block(tmp_path: Path) -> Path:
    """A file of a convex part, which is made soon."""
    return made.write_step(made.box(3, 3, 3, (0, 0, 20)), tmp_path / "block.step")


def numbers_of(assembly: Assembly) -> list[Any]:
    """All that answers follow from, to the last bit."""
    found: list[Any] = []
    for part in assembly:
        solid = part.solid
        arrays = (part.pose, solid.boundary.ints, solid.boundary.reals, solid.own, solid.numbers)
        told = part.name, part.colour, part.report, part.shape.check(), part.shape.digest
        found += [*(a.tobytes() for a in arrays), *told, solid.edges_sampled]
        if not part.report.convex:
            found.append(repr(solid.self_intersections))
    return found


SECOND = """
import sys
from standoff.cad import read_cad
read = read_cad(sys.argv[1])
assert read.stored and not {"OCP", "numba"} & set(sys.modules)
base = read.parts[0]
print(base.solid.contains([[1, 1, 1], [10, 10, 1]]).tolist(), base.shape.digest)
assert "OCP" not in sys.modules
"""


def test_the_second_reading_gives_the_same_without_opencascade(kept: Path, file: Path) -> None:
    first = so.read_step(file)
    assert not first.stored
    again = so.read_step(file)
    assert again.stored
    assert numbers_of(again) == numbers_of(first)
    assert (again.unit, again.file_unit, again.source) == ("mm", "mm", "plates.step")
    assert "read before" in again.report()
    assert so.cad.reports_of(file) == tuple(part.report for part in first.parts[:2])
    command = [sys.executable, "-c", SECOND, str(file.rename(file.with_name("other.STEP")))]
    ended = subprocess.run(command, capture_output=True, text=True, check=True)
    assert ended.stdout.strip() == f"[True, False] {first.parts[0].shape.digest}"


def test_a_part_is_known_in_another_file_too(
    kept: Path, block: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = so.read_step(block)
    other = block.parent / "dated" / block.name  # which names the part
    other.parent.mkdir()
    other.write_text(block.read_text("utf-8") + "\n", "utf-8")
    monkeypatch.setattr("standoff.cad.making.made_part", lambda *given: pytest.fail("made again"))
    found = so.read_step(other)
    assert not found.stored
    assert numbers_of(found) == numbers_of(first)


def test_instances_share_one_solid(kept: Path, file: Path) -> None:
    for _ in range(2):  # made, and from the store
        base, cube, moved = so.read_step(file)
        assert base.shape is moved.shape
        assert base.solid is moved.solid is base.body
        assert cube.body is cube.shape
        world = so.World({part.name: part.shape for part in (base, moved)})
        assert all(solid is base.solid for solid in world.bodies.values())


def test_what_reading_follows_from_is_in_the_name(
    kept: Path, block: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    so.read_step(block)
    size = so.read_step(block).parts[0].report.size
    inches = so.read_step(block, unit="inch")
    assert not inches.stored
    assert inches.parts[0].report.size == pytest.approx(size / 25.4)
    assert not so.read_step(block, heal=True).stored
    assert so.read_step(block, keep="readable").stored
    monkeypatch.setattr(store, "code_digest", lambda: b"another version")
    assert not so.read_step(block).stored


def test_a_file_that_changes_under_its_name(
    kept: Path, block: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    so.read_step(block)
    state = block.stat()
    made.write_step(made.box(3, 3, 9, (0, 0, 20)), block)
    os.utime(block, (state.st_atime, state.st_mtime))
    assert so.read_step(block).parts[0].report.volume == pytest.approx(81.0)
    whole = instances.step_instances

    def read(path: Path, unit: str) -> Any:
        found = whole(path, unit)
        path.write_text(path.read_text("utf-8") + " ", "utf-8")
        return found

    monkeypatch.setattr(instances, "step_instances", read)
    made.write_step(made.box(1, 2, 3), block)
    with pytest.raises(CadError, match="changed while it was read"):
        so.read_step(block)


DAMAGE = {
    "truncated": lambda content, other: content[:-1],
    "empty": lambda content, other: b"",
    "a bit": lambda content, other: content[:200] + bytes([content[200] ^ 1]) + content[201:],
    "another part's": lambda content, other: other,
    "another format": lambda content, other: b"standoff part 0\n" + content[16:],
}


@pytest.mark.parametrize("damage", DAMAGE)
def test_a_damaged_store(kept: Path, damage: str, capsys: pytest.CaptureFixture[str]) -> None:
    here, other = store.key_of(b"one", "solid"), store.key_of(b"two", "solid")
    for key in (here, other):
        store.put(key, pickle.dumps(key * 10))
    kept_file = kept / f"{here}.part"
    changed = DAMAGE[damage](kept_file.read_bytes(), (kept / f"{other}.part").read_bytes())
    kept_file.write_bytes(changed)
    assert store.taken(here) is None
    assert "damaged" in capsys.readouterr().err
    assert not kept_file.exists()
    assert pickle.loads(store.taken(other) or b"") == other * 10


def test_a_part_that_is_gone_is_made_again(kept: Path, block: Path) -> None:
    first = so.read_step(block)
    largest = max(store.entries(), key=lambda entry: entry.size)
    largest.file.unlink()
    again = so.read_step(block)
    assert not again.stored
    for one, other in zip(first, again, strict=True):
        np.testing.assert_array_equal(one.solid.numbers, other.solid.numbers)
    assert so.read_step(block).stored


def test_what_was_used_longest_ago_goes_first(kept: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(store.SIZE, "0.01")
    for k in range(12):
        store.put(f"{k:x}", bytes(1000))
        os.utime(kept / f"{k:x}.part", (k, k))
    stale = kept / ".0123.part"
    stale.write_bytes(b"of a writer that was killed")
    os.utime(stale, (0, 0))
    assert store.taken("1") == bytes(1000)
    store.trim()
    assert [entry.file.stem for entry in store.entries()] == [
        "5",
        "6",
        "7",
        "8",
        "9",
        "a",
        "b",
        "1",
    ]
    assert not stale.exists()
    assert sum(entry.size for entry in store.entries()) <= 9000


@pytest.mark.parametrize("fault", ["too large", "a file", "others write", "full", "no home"])
def test_reading_goes_on_without_a_store(
    kept: Path,
    block: Path,
    fault: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    if fault == "too large":
        monkeypatch.setenv(store.SIZE, "1e-5")
    elif fault == "a file":
        kept.write_text("not a folder")
    elif fault == "others write":
        kept.mkdir()
        kept.chmod(0o777)
    elif fault == "no home":
        for name in (store.FOLDER, "NUMBA_CACHE_DIR"):
            monkeypatch.delenv(name, raising=False)
        monkeypatch.setattr(Path, "home", _homeless)
    else:
        monkeypatch.setattr(store, "write_whole", _no_space)
    for _ in range(2):
        assert [part.report.refused for part in so.read_step(block)] == [""]
    told = [x for x in capsys.readouterr().err.splitlines() if "so far" not in x]
    assert len(told) == 1
    assert ("not using the store" if fault == "others write" else "could not be kept") in told[0]
    if kept.is_dir():
        assert not list(kept.iterdir())


def _homeless() -> Path:
    raise RuntimeError("Could not determine home directory.")


def _no_space(files: Any) -> None:
    raise OSError(28, "No space left on device")


@pytest.mark.parametrize("size", ["much", "-1", "nan", "inf"])
def test_a_size_that_is_none_is_refused(
    kept: Path, block: Path, size: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(store.SIZE, size)
    with pytest.raises(StandoffError, match=r"STANDOFF_CACHE_SIZE = .* give a number"):
        so.read_step(block)


RACE = """
import hashlib, random, sys
from standoff.cad import store
draw = random.Random(int(sys.argv[1]))
hits = 0
for _ in range(300):
    key = f"{draw.randrange(12):x}"
    content = hashlib.sha256(key.encode()).digest() * draw.choice([60, 60, 60])
    found = store.taken(key)
    if found is None:
        store.put(key, content)
        store.trim()
    else:
        assert found == content
        hits += 1
print(hits)
"""


def test_two_programs_share_a_store(kept: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(store.SIZE, "0.016")
    both = [
        subprocess.Popen(
            [sys.executable, "-c", RACE, str(k)],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        for k in range(2)
    ]
    for each in both:
        out, err = each.communicate(timeout=60)
        assert (each.returncode, err) == (0, "")
        assert int(out) > 30
    assert sum(entry.size for entry in store.entries()) <= 16000 + 2000
    assert not [each for each in kept.iterdir() if each.name.startswith(".")]


def test_two_processes_make_the_same_in_the_same_order(kept: Path, file: Path) -> None:
    alone = so.read_step(file)
    store.clear()
    shared = so.read_step(file, workers=2)
    assert not shared.stored
    seconds = [part.report.seconds for part in alone]
    for part, spent in zip(shared, seconds, strict=True):
        object.__setattr__(part.report, "seconds", spent)
    assert numbers_of(shared) == numbers_of(alone)
    with pytest.raises(StandoffError, match="workers = 0"):
        so.read_step(file, workers=0)


def test_how_far_it_has_come_is_told(
    block: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(reading, "FIRST_LINE", 0.0)
    so.read_step(block)
    assert "standoff: reading block.step: " in capsys.readouterr().err
    watch = reading.Watch("a.step", 0.0, parts=4, done=1, share=0.25)
    watch.making = watch.began = reading.perf_counter() - 20.0
    assert watch.line() == "reading a.step: 1 of 4 parts made, 20 s so far, about 60 s left ..."
    monkeypatch.setenv("STANDOFF_QUIET", "1")
    so.read_step(block)
    assert capsys.readouterr().err == ""
