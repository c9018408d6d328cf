"""Writing files: whole or not at all, only regular ones, through links, and in one place."""

from __future__ import annotations

import ast
import os
import stat
from pathlib import Path
from typing import BinaryIO

import pytest

import standoff
import standoff_studies
from families import file_kinds
from standoff.whole_files import UnfitTarget, file_name, write_whole

SOURCES = [Path(package.__file__).parent for package in (standoff, standoff_studies)]

WRITES = {"write_text", "write_bytes", "touch", "rename", "symlink_to", "hardlink_to"}
WRITES |= {"truncate", "tofile", "savetxt", "savez", "copyfile", "NamedTemporaryFile"}
DRAWN = {"savefig": 0, "write_table": 1, "dump": 1}
"""Calls that write to a path or to a stream, and where it stands among their arguments."""

STREAMS = {"file", "stream", "buffer"}

KNOWN = {
    # the one place
    "whole_files.py",
}


def inner(file: BinaryIO) -> None:
    file.write(b"new")


def writing(call: ast.Call) -> bool:
    """Does a call open a file for writing, or write to a path?"""
    name = getattr(call.func, "attr", getattr(call.func, "id", ""))
    if name in WRITES or ast.unparse(call.func) in (
        "os.replace",
        "os.link",
        "shutil.copy",
        "shutil.move",
    ):
        return True
    if name == "dump" and len(call.args) == 1 and not call.keywords:
        return False  # a pickler's, to the stream that it was made with, whose opening is seen
    if name in DRAWN:
        sink = call.args[DRAWN[name]] if len(call.args) > DRAWN[name] else None
        # Our own write_table takes the stream last, like pyarrow's.
        return not (isinstance(sink, ast.Name) and sink.id in STREAMS)
    words = [a.value for a in (*call.args, *(k.value for k in call.keywords)) if is_text(a)]
    return name == "open" and any(set(word) & set("wax+") for word in words)


def is_text(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def test_no_other_module_writes_a_file() -> None:
    found = {}
    for source, path in ((s, path) for s in SOURCES for path in s.rglob("*.py")):
        calls = [n for n in ast.walk(ast.parse(path.read_text("utf-8"))) if isinstance(n, ast.Call)]
        lines = [call.lineno for call in calls if writing(call)]
        if lines:
            found[path.relative_to(source).as_posix()] = lines
    assert set(found) - KNOWN == set(), found
    assert "whole_files.py" in found, "the check sees no writing at all"


@pytest.mark.parametrize("kind", file_kinds.MAKERS)
@pytest.mark.parametrize("linked", [False, True])
def test_what_is_no_regular_file_is_refused_by_name(
    tmp_path: Path, kind: str, linked: bool
) -> None:
    thing, beside = tmp_path / "thing", tmp_path / "beside"
    file_kinds.make(kind, thing)
    target = thing
    if linked:
        target = tmp_path / "link"
        file_kinds.link(target, "thing")
    before = file_kinds.looks(thing)
    with pytest.raises(UnfitTarget, match=rf"{target}: is a {kind}; name a"):
        write_whole({beside: inner, target: inner})
    assert file_kinds.looks(thing) == before
    assert target.is_symlink() == linked
    assert not beside.exists()
    assert {path.name for path in tmp_path.iterdir()} == {"thing", target.name}


@pytest.mark.parametrize("there", [True, False])
def test_a_link_stays_and_what_it_leads_to_is_replaced(tmp_path: Path, there: bool) -> None:
    folder = tmp_path / "runs"
    folder.mkdir()
    if there:
        (folder / "last").write_bytes(b"old")
    file_kinds.link(tmp_path / "one", "two")
    file_kinds.link(tmp_path / "two", Path("runs") / "last")
    write_whole({tmp_path / "one": inner})
    assert (tmp_path / "one").is_symlink()
    assert (tmp_path / "two").is_symlink()
    assert (folder / "last").read_bytes() == b"new"
    assert [path.name for path in folder.iterdir()] == ["last"]
    assert {path.name for path in tmp_path.iterdir()} == {"one", "two", "runs"}


def test_a_circle_of_links_is_refused(tmp_path: Path) -> None:
    file_kinds.link(tmp_path / "one", "two")
    file_kinds.link(tmp_path / "two", "one")
    with pytest.raises(OSError, match="one"):
        write_whole({tmp_path / "one": inner})
    assert (tmp_path / "one").is_symlink()


def test_the_permissions_of_a_file_stay(tmp_path: Path) -> None:
    file = tmp_path / "private"
    file.write_bytes(b"old")
    file.chmod(0o600)
    before = stat.S_IMODE(file.stat().st_mode)
    write_whole({file: inner})
    assert file.read_bytes() == b"new"
    assert stat.S_IMODE(file.stat().st_mode) == before


def test_two_names_of_one_file_are_refused(tmp_path: Path) -> None:
    file_kinds.link(tmp_path / "link", "file")
    with pytest.raises(UnfitTarget, match="another of the files to write"):
        write_whole({tmp_path / "file": inner, tmp_path / "link": inner})
    assert not (tmp_path / "file").exists()


def test_the_longest_name_of_a_file_is_written(tmp_path: Path) -> None:
    longest = os.pathconf(tmp_path, "PC_NAME_MAX") if hasattr(os, "pathconf") else 200
    write_whole({tmp_path / ("x" * longest): inner})
    assert (tmp_path / ("x" * longest)).read_bytes() == b"new"


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("no/file", r"the folder .*no does not exist; create it"),
        ("taken/file", r"taken is a file, not a folder; name a folder"),
        ("a\0b", "is not a file name"),
    ],
)
def test_names_that_no_file_can_have(tmp_path: Path, name: str, words: str) -> None:
    (tmp_path / "taken").touch()
    with pytest.raises(UnfitTarget, match=words):
        write_whole({tmp_path / name: inner})
    assert [path.name for path in tmp_path.iterdir()] == ["taken"]


def test_an_empty_text_names_no_file() -> None:
    with pytest.raises(ValueError, match="an empty string is not a file name"):
        file_name("")
    with pytest.raises(TypeError, match="path is 3: give a file name"):
        file_name(3)
    with pytest.raises(UnfitTarget, match="is a folder; name a file in it"):
        write_whole({Path(""): inner})
