"""Figures by their keys, their files, and how one that fails leaves the others alone."""

from __future__ import annotations

import io
import json
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import BinaryIO

import numpy as np
import pyarrow.parquet as pq
import pytest
from PIL import Image

from families import paper_figures as fakes
from standoff_studies.paper import catalogue, writers
from standoff_studies.paper.catalogue import UnknownFigure, chosen, make
from standoff_studies.paper.making import Made, make_and_write
from standoff_studies.paper.processes import Order, make_all
from standoff_studies.paper.verdicts import Verdict, counted
from standoff_studies.paper.writers import animation_bytes, picture_bytes, stem, table_bytes

PAGES = Path(__file__).parents[2] / "docs" / "paper"


@pytest.fixture
def fake_catalogue(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(catalogue, "CATALOGUE", fakes.ALL)


def keys(*given: str) -> list[str]:
    return [entry.key for entry in chosen(given)]


@pytest.mark.usefixtures("fake_catalogue")
def test_keys_name_figures_in_the_order_of_the_report() -> None:
    assert keys("all") == ["7", "12", "13", "14", "gains", "verdict"]
    assert keys("Gains", "07", "7") == ["7", "gains"]
    assert keys("8-13", "14") == ["12", "13", "14"]


@pytest.mark.usefixtures("fake_catalogue")
@pytest.mark.parametrize(
    ("key", "message"),
    [
        ("5", "unknown figure '5'; known here: 7, 12, 13, 14, gains, verdict, convergence, all"),
        ("gians", "did you mean 'gains'"),
        ("verdcit", "did you mean 'verdict'"),
        ("1-6", "unknown figure '1-6'"),
        ("13-12", "unknown figure '13-12'"),
        ("7-", "unknown figure '7-'"),
        ("", "unknown figure ''"),
    ],
)
def test_a_key_that_no_figure_has_is_refused(key: str, message: str) -> None:
    with pytest.raises(UnknownFigure, match=message):
        keys("7", key)


def test_every_figure_of_the_paper_is_listed_once_and_in_order() -> None:
    known = [entry.key for entry in catalogue.CATALOGUE]
    assert len(set(known)) == len(known)
    numbers = [int(key) for key in known if key.isdecimal()]
    assert numbers == sorted(numbers)
    assert known[: len(numbers)] == [str(number) for number in numbers]
    chapters = [entry.chapter for entry in catalogue.CATALOGUE]
    begun = [c for k, c in enumerate(chapters) if k == 0 or chapters[k - 1] != c]
    assert len(set(begun)) == len(begun), "a chapter's figures stand together"


def test_a_figure_is_written_with_its_data(tmp_path: Path) -> None:
    made = make_and_write(fakes.GOOD, tmp_path, animations=True)
    assert made.error == ""
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        *("figure-07-steps.parquet", "figure-07.png", "figure-07.svg")
    ]
    assert set(made.files) == set(tmp_path.iterdir())
    assert Image.open(tmp_path / "figure-07.png").size == (480, 320)
    table = pq.read_table(tmp_path / "figure-07-steps.parquet")
    assert table.to_pydict() == {
        "time_s": [0.0, 1.0, 2.0],
        "mode": ["a", "b", "b"],
        "steps": [0, 1, 2],
    }
    told = json.loads(table.schema.metadata[b"standoff"])
    assert (told["figure"], told["table"]) == ("7", "steps")
    # A comparison's numpy bool has become Python's own, which JSON and the report can tell.
    assert [s.holds for s in made.statements] == [True, False, None, True]
    assert made.statements[0].holds is True


def test_the_same_figure_gives_the_same_bytes() -> None:
    artwork = make(fakes.GOOD)
    assert picture_bytes(artwork) == picture_bytes(artwork)
    table = artwork.tables["steps"]
    assert table_bytes(fakes.GOOD, "steps", table) == table_bytes(fakes.GOOD, "steps", table)


def test_an_animation_has_its_frames_and_their_time() -> None:
    animation = make(fakes.MOVING).animation
    assert animation is not None
    picture = Image.open(io.BytesIO(animation_bytes(animation)))
    assert (picture.format, picture.n_frames, picture.info["loop"]) == ("WEBP", 4, 0)
    assert picture.size == (320, 320)
    frames = []
    for k in range(4):
        picture.seek(k)
        picture.load()
        assert picture.info["duration"] == 100
        frames.append(np.asarray(picture.convert("RGB")).astype(int))
    assert len({frame.tobytes() for frame in frames}) == 4
    coloured = [int((frame.max(axis=2) > frame.min(axis=2) + 100).sum()) for frame in frames]
    assert max(coloured) < 1.5 * min(coloured), "a frame keeps nothing of the one before"
    wide = replace(animation, size=(9.0, 4.5))
    assert Image.open(io.BytesIO(animation_bytes(wide))).size == (900, 450)
    with pytest.raises(ValueError, match="needs a frame"):
        animation_bytes(replace(animation, frames=0))


def test_animations_may_be_left_out(tmp_path: Path) -> None:
    make_and_write(fakes.MOVING, tmp_path, animations=False)
    assert {path.suffix for path in tmp_path.iterdir()} == {".png", ".svg"}
    made = make_and_write(fakes.MOVING, tmp_path, animations=True)
    assert made.file(".webp") == tmp_path / "figure-12.webp"
    assert made.animation_text == "A dot goes up."


@pytest.mark.parametrize(
    "columns", [{"a": [1.0, 2.0], "b": [1.0]}, {"a": np.zeros((2, 2))}, {"a": 1.0}]
)
def test_tables_must_be_flat_and_of_one_length(columns: dict[str, object]) -> None:
    with pytest.raises(ValueError, match=r"table 'x' of figure 7: columns must be flat"):
        table_bytes(fakes.GOOD, "x", columns)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("entry", "error"),
    [
        (fakes.FAILING, r"ZeroDivisionError: no reason \(paper_figures.py, line \d+\)"),
        (fakes.WRONG, "TypeError: .* gave no Artwork but 'no artwork'"),
        (fakes.GOOD._replace(function="absent"), "AttributeError"),
        (fakes.GOOD._replace(module="standoff_studies.paper.absent"), "ModuleNotFoundError"),
    ],
)
def test_a_figure_that_fails_says_why_and_writes_nothing(
    tmp_path: Path, entry: catalogue.Entry, error: str
) -> None:
    made = make_and_write(entry, tmp_path, animations=True)
    assert not made.files
    assert not made.unwritten
    assert not list(tmp_path.iterdir())
    with pytest.raises(ValueError, match=error):
        raise ValueError(made.error)


def test_a_full_disk_leaves_nothing_of_a_figure(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write = writers._writer

    def full(file: BinaryIO) -> None:
        file.write(b"half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(
        writers, "_writer", lambda data: full if data.startswith(b"<?xml") else write(data)
    )
    made = make_and_write(fakes.GOOD, tmp_path, animations=True)
    assert made.unwritten
    assert "No space left" in made.error
    assert not list(tmp_path.iterdir())


def test_one_process_makes_all_in_their_order(tmp_path: Path) -> None:
    told: list[tuple[str, bool]] = []
    entries = [fakes.GOOD, fakes.MOVING, fakes.FAILING, fakes.LAST]
    made = make_all(
        entries, Order(tmp_path, False), 1, lambda e, made: told.append((e.key, made is None))
    )
    assert [one.entry for one in made] == entries
    assert [bool(one.error) for one in made] == [False, False, True, False]
    assert told == [(e.key, begun) for e in entries for begun in (True, False)]


def test_a_process_that_dies_spoils_only_its_figure(tmp_path: Path) -> None:
    """Two spawned processes; the one that dies does so between two others of its chapter."""
    chapter = [
        fakes.entry("8", "Before", "Simulation B", function="good"),
        fakes.entry("9", "Dies", "Simulation B", function="dying"),
        fakes.entry("10", "After", "Simulation B", function="good"),
    ]
    told: list[tuple[str, bool]] = []

    def tell(entry: catalogue.Entry, made: Made | None) -> None:
        told.append((entry.key, made is None))

    entries = [fakes.GOOD, *chapter, fakes.FAILING]
    made = make_all(entries, Order(tmp_path, False), 2, tell)
    assert [one.entry for one in made] == entries
    assert [bool(one.error) for one in made] == [False, False, True, False, True]
    assert "exit code 9" in made[2].error
    assert sorted(told) == sorted((e.key, begun) for e in entries for begun in (True, False))
    assert {stem(e) for e in entries} - {path.stem for path in tmp_path.glob("*.png")} == {
        *("figure-09", "figure-13")
    }


def test_only_what_the_paper_states_can_hold_or_fail() -> None:
    assert counted(fakes.STATEMENTS) == {
        Verdict.HOLDS: 1,
        Verdict.FAILS: 1,
        Verdict.OPEN: 1,
        Verdict.CONSTRUCTED: 0,
        Verdict.OWN: 1,
    }
    assert len({verdict.sign for verdict in Verdict}) == 5


def test_what_is_true_by_construction_is_counted_apart_unless_it_fails() -> None:
    built = [statement._replace(constructed=True) for statement in fakes.STATEMENTS]
    assert counted(built) == {
        Verdict.HOLDS: 0,
        Verdict.FAILS: 1,
        Verdict.OPEN: 1,
        Verdict.CONSTRUCTED: 1,
        Verdict.OWN: 1,
    }


def test_every_figure_has_its_function_and_a_page() -> None:
    """The pages show each figure and its statements, made by the function the command runs."""
    pages = "".join(page.read_text("utf-8") for page in PAGES.glob("*.md"))
    for entry in catalogue.CATALOGUE:
        assert callable(getattr(import_module(entry.module), entry.function)), entry.key
        assert f"```{{paper-figure}} {entry.key}\n```" in pages, entry.key
        assert f"```{{paper-statements}} {entry.key}\n```" in pages, entry.key
