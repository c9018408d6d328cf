"""The package itself: its version, and what a wheel of it declares."""

from importlib.metadata import version
from importlib.resources import files

import standoff


def test_version_is_the_installed_one() -> None:
    assert version("standoff") == standoff.__version__


def test_package_is_marked_as_typed() -> None:
    assert files("standoff").joinpath("py.typed").is_file()
