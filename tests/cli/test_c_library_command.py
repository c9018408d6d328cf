"""`standoff c-library`: where it writes, and what it says where there is no compiler."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from standoff.c_interface.library import NAMES
from standoff.cli import c_library

Standoff = Callable[..., Any]


def built(
    folder: Path, processor: str | None, progress: Callable[[int, int], None]
) -> tuple[Path, Path]:
    progress(1, 2)
    (folder / "processor").write_text(str(processor))
    return folder / "libstandoff.so", folder / "standoff.h"


def test_it_makes_the_folder_and_tells_the_files(
    standoff: Standoff, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(c_library, "build_library", built)
    folder = tmp_path / "a" / "b"
    ended = standoff("c-library", str(folder))
    assert (ended.code, ended.err) == (0, "")
    assert f"-I{folder} -L{folder} -lstandoff -lm -o program" in ended.out
    ended = standoff("c-library", str(folder), "--processor", "x86-64-v3", "--json")
    assert json.loads(ended.out) == {
        "library": str(folder / "libstandoff.so"),
        "header": str(folder / "standoff.h"),
    }
    assert (folder / "processor").read_text() == "x86-64-v3"


PROGRAM = """#include "standoff.h"
#include <math.h>
#include <stdio.h>
int main(int argc, char **argv) {
    (void)argv;
    printf("%g %s\\n", cos((double)(argc - 1)), standoff_version());
    return 0;
}
"""
LIBRARY = 'const char *standoff_version(void) { return "of the library"; }\n'


@pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler")
@pytest.mark.parametrize("named", ["plain", "with blanks, and a comma's"])
def test_the_advice_compiles_and_runs_as_it_is_printed(
    standoff: Standoff, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, named: str
) -> None:
    """With a library of one function in place of the whole."""

    def small(
        folder: Path, processor: str | None, progress: Callable[[int, int], None]
    ) -> tuple[Path, Path]:
        (folder / "library.c").write_text(LIBRARY)
        (folder / "standoff.h").write_text("const char *standoff_version(void);\n")
        library = folder / NAMES[sys.platform]
        command = ["cc", "-shared", "-fPIC", "-o", str(library), str(folder / "library.c")]
        subprocess.run(command, check=True)
        return library, folder / "standoff.h"

    monkeypatch.delenv("CC", raising=False)
    monkeypatch.delenv("LD_LIBRARY_PATH", raising=False)
    monkeypatch.setattr(c_library, "build_library", small)
    monkeypatch.chdir(tmp_path)
    out = standoff("c-library", named).out
    command = out.rpartition("compile a program with: ")[2]
    for place in ("here", "there"):  # from any folder
        (tmp_path / place).mkdir()
        (tmp_path / place / "program.c").write_text(PROGRAM)
        shell = {"shell": True, "cwd": tmp_path / place, "capture_output": True, "text": True}
        done = subprocess.run(command, check=False, **shell)
        assert (done.returncode, done.stderr) == (0, "")
        assert subprocess.run("./program", check=False, **shell).stdout == "1 of the library\n"


def test_no_compiler_is_bad_input(
    standoff: Standoff, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CC", "no-such-cc")
    ended = standoff("c-library", str(tmp_path))
    assert (ended.code, ended.out) == (2, "")
    assert "no C compiler 'no-such-cc'" in ended.err
