"""The package itself: its version, and what a wheel of it declares and holds."""

from __future__ import annotations

import tomllib
from importlib.metadata import entry_points, version
from importlib.resources import files
from pathlib import Path

import pytest

import standoff
from standoff.cli.added import GROUP, STUDIES

ROOT = Path(__file__).parents[1]
PACKAGES = ("standoff", "standoff_studies")
DECLARED = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))


def test_version_is_the_installed_one() -> None:
    assert version("standoff") == standoff.__version__


@pytest.mark.parametrize("package", PACKAGES)
def test_package_is_marked_as_typed(package: str) -> None:
    assert files(package).joinpath("py.typed").is_file()


def test_the_wheel_holds_every_package_of_the_source() -> None:
    packed = DECLARED["tool"]["hatch"]["build"]["targets"]["wheel"]["packages"]
    there = {file.parent.name for file in (ROOT / "src").glob("*/__init__.py")}
    assert sorted(packed) == sorted(f"src/{package}" for package in there)
    assert there == set(PACKAGES)


def test_the_studies_commands_are_declared_and_installed() -> None:
    declared = DECLARED["project"]["entry-points"][GROUP]
    assert tuple(declared) == STUDIES
    installed = {point.name: point.value for point in entry_points(group=GROUP)}
    assert declared.items() <= installed.items(), "install the package anew: pip install -e ."
