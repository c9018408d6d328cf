"""Commands of other packages: found by entry points, and missed with a clear message."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import EntryPoint, EntryPoints
from pathlib import Path
from typing import Any

import pytest

from standoff.cli import added
from standoff.cli.errors import CommandError

Standoff = Callable[..., Any]


@dataclass(frozen=True)
class Greet:
    """Say hello to somebody."""

    to: str = "nobody"

    def announcement(self) -> str:
        return f"greeting {self.to}"

    def run(self) -> int:
        if self.to == "nobody":
            raise CommandError("--to: name somebody")
        print(f"hello, {self.to}")
        return 7


@pytest.fixture
def points(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """Put these entry points in the place of the installed ones."""

    def replace(**values: str) -> None:
        each = EntryPoints(EntryPoint(n, value, added.GROUP) for n, value in values.items())
        monkeypatch.setattr(added, "entry_points", lambda *, group: each.select(group=group))

    return replace


def test_a_package_adds_a_command(
    standoff: Standoff, points: Callable[..., None], monkeypatch: pytest.MonkeyPatch
) -> None:
    points(greet=f"{__name__}:Greet")
    assert "Say hello to somebody." in standoff("--help").out
    ended = standoff("greet", "--to", "you")
    assert (ended.code, ended.out, ended.err) == (7, "hello, you\n", "")
    monkeypatch.setenv("STANDOFF_QUIET", "0")
    ended = standoff("greet")
    said = "standoff: greeting nobody ...\nstandoff: --to: name somebody\n"
    assert (ended.code, ended.out, ended.err) == (2, "", said)


def test_no_package_takes_the_place_of_a_command_of_the_library(
    standoff: Standoff, points: Callable[..., None]
) -> None:
    points(warmup=f"{__name__}:Greet")
    assert "Say hello" not in standoff("warmup", "--help").out
    helped = standoff("--help").out
    assert "Compile all kernels ahead" in helped
    assert "Say hello" not in helped


@pytest.mark.parametrize("name", added.STUDIES)
def test_absent_studies_are_named(
    standoff: Standoff, points: Callable[..., None], passing: Path, name: str
) -> None:
    points()
    ended = standoff(name, "--help")
    assert (ended.code, ended.out) == (2, "")
    assert ended.err == (
        f"standoff: the command '{name}' belongs to the studies, which are not installed: "
        "pip install standoff-studies, or, in a clone of Standoff, pip install -e ./studies\n"
    )
    assert name not in standoff("--help").out.splitlines()[0]
    assert standoff("check", passing).code == 0


def test_a_package_that_cannot_be_imported_is_told_only_who_asks_for_it(
    standoff: Standoff, points: Callable[..., None]
) -> None:
    points(greet=f"{__name__}:Greet", lost="no_such_package.arguments:Command")
    ended = standoff("lost")
    assert (ended.code, ended.out) == (2, "")
    assert "'lost' cannot be loaded from no_such_package.arguments:Command (Module" in ended.err
    helped = standoff("--help")
    assert helped.code == 0
    assert "greet" in helped.out
    assert "lost" not in helped.out


def test_the_library_alone_runs_its_commands(passing: Path) -> None:
    """With no package of the studies to import, though their entry points are installed."""
    code = (
        "import sys\n"
        "sys.modules['standoff_studies'] = None\n"
        "from standoff.cli import main\n"
        "print(main(sys.argv[1:]))"
    )

    def ended(*arguments: object) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-c", code, *map(str, arguments)]
        return subprocess.run(command, capture_output=True, text=True, check=True)

    assert ended("distance", passing).stdout.endswith("\n0\n")
    assert "warmup" in ended("--help").stdout
    refused = ended("soak")
    assert refused.stdout == "2\n"
    assert "the command 'soak' cannot be loaded from standoff_studies.soak" in refused.stderr
