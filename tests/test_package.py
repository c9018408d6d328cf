"""The package itself: its version, and what a wheel of it declares and holds."""

from __future__ import annotations

import tomllib
from importlib.metadata import entry_points, version
from importlib.resources import files
from itertools import chain
from pathlib import Path

import pytest
from packaging.requirements import Requirement

import standoff
from standoff.cli.added import GROUP, STUDIES

ROOT = Path(__file__).parents[1]
FOLDERS = {"standoff": ROOT, "standoff_studies": ROOT / "studies"}
"""Of each package the folder with its declaration; each is a distribution of its own."""
DECLARED = {
    package: tomllib.loads((folder / "pyproject.toml").read_text("utf-8"))
    for package, folder in FOLDERS.items()
}


def test_version_is_the_installed_one() -> None:
    assert version("standoff") == standoff.__version__


@pytest.mark.parametrize("package", FOLDERS)
def test_package_is_marked_as_typed(package: str) -> None:
    assert files(package).joinpath("py.typed").is_file()


@pytest.mark.parametrize("package", FOLDERS)
def test_each_wheel_holds_its_package_alone(package: str) -> None:
    folder = FOLDERS[package]
    packed = DECLARED[package]["tool"]["hatch"]["build"]["targets"]["wheel"]["packages"]
    assert packed == [f"src/{package}"]
    there = [file.parent.name for file in (folder / "src").glob("*/__init__.py")]
    assert there == [package]


def test_the_studies_are_of_the_library_s_version_and_licence() -> None:
    project = DECLARED["standoff_studies"]["project"]
    assert project["version"] == standoff.__version__
    needed = [Requirement(each) for each in project["dependencies"]]
    (library,) = [each for each in needed if each.name == "standoff"]
    assert library.specifier.contains(standoff.__version__)
    major, minor, _ = standoff.__version__.split(".")
    assert not library.specifier.contains(f"{major}.{int(minor) + 1}.0")
    own, theirs = [(folder / "LICENSE").read_bytes() for folder in FOLDERS.values()]
    assert own == theirs


def test_what_both_declare_has_one_range() -> None:
    library, studies = [
        {Requirement(each).name: each for each in declared(package)} for package in FOLDERS
    ]
    both = library.keys() & studies.keys() - {"standoff"}
    assert {"numpy", "numba", "tyro"} <= both
    assert {name: library[name] for name in both} == {name: studies[name] for name in both}


def declared(package: str) -> list[str]:
    """All that a distribution needs, with its extras."""
    project = DECLARED[package]["project"]
    return [*project["dependencies"], *chain(*project["optional-dependencies"].values())]


def test_the_studies_commands_are_declared_and_installed() -> None:
    assert GROUP not in DECLARED["standoff"]["project"].get("entry-points", {})
    declared = DECLARED["standoff_studies"]["project"]["entry-points"][GROUP]
    assert tuple(declared) == STUDIES
    installed = {point.name: point.value for point in entry_points(group=GROUP)}
    assert declared.items() <= installed.items(), "install them anew: pip install -e ./studies"
