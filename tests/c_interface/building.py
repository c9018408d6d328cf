"""The library that tests link with; ``python tests/c_interface/building.py FOLDER`` builds it.

`.ci/run` does so ahead, on a core that would be idle while kernels are compiled, and names the
folder to the tests.
"""

import os
import shutil
import sys
from pathlib import Path

from standoff.c_interface import build_library

BUILT = "STANDOFF_BUILT_C_LIBRARY"
"""In the environment: a folder in which `build` has built from the sources of now."""

PROGRESS = "progress"


def build(folder: Path) -> None:
    """The library and its header; ``progress`` has what was told meanwhile."""
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / PROGRESS).open("w") as told:
        build_library(folder, progress=lambda done, total: print(done, total, file=told))


def put_library(folder: Path) -> None:
    """Into an empty folder: what was built ahead if the environment names it, or built now."""
    built = os.environ.get(BUILT)
    if built is None:
        build(folder)
    else:
        shutil.copytree(built, folder, dirs_exist_ok=True)


if __name__ == "__main__":
    build(Path(sys.argv[1]))
