"""Coal's functor called from C++, built against the headers of the installed Python package.

Built in a temporary folder; the poses come through a binary file, and it has its own clock.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from benchmarks.bench.contender import Contender, Found, Missing
from benchmarks.bench.motion import Frames, Pair
from standoff_studies.accuracy.peers.answer import require

NAME = "Coal, C++, cached guess, default"
SOURCE = Path(__file__).with_name("coal_race.cpp")
EIGEN = "EIGEN_INCLUDE"
"""The environment's variable that names a folder with Eigen's headers."""
DEADLINE = 300
"""Longest time for the compiler, s."""


def contenders(pair: Pair, frames: Frames) -> list[Contender | Missing]:
    """One, on ellipsoids; or what it lacks here."""
    if "C++" not in pair.more:
        return []
    try:
        return [_contender(pair, frames)]
    except (ImportError, OSError, subprocess.SubprocessError) as error:
        return [Missing(NAME, str(error))]


def _prefix() -> Path:
    """The folder where the Python package keeps Coal's headers and libraries."""
    for folder in Path(require("coal").__file__).parents:
        if (folder / "include" / "coal").is_dir():
            return folder
    raise FileNotFoundError("the installed Coal has no headers: pip install libcoal")


def _eigen(prefix: Path) -> Path:
    named = [Path(os.environ[EIGEN])] if os.environ.get(EIGEN) else []
    usual = [prefix / "include" / "eigen3", Path("/usr/include/eigen3")]
    for folder in [*named, *usual]:
        if (folder / "Eigen" / "Core").is_file():
            return folder
    raise FileNotFoundError(
        f"no Eigen headers: pip install cmeel-eigen, or name their folder in {EIGEN}"
    )


def _built(folder: Path) -> Path:
    """Compile the race; returns the program."""
    prefix = _prefix()
    compiler = shutil.which("g++") or shutil.which("clang++")
    if compiler is None:
        raise FileNotFoundError("no C++ compiler: install g++")
    if not (prefix / "include" / "boost").is_dir():
        raise FileNotFoundError("no Boost headers: pip install cmeel-boost")
    program = folder / "coal_race"
    include = [f"-I{prefix / 'include'}", f"-isystem{_eigen(prefix)}"]
    # what libcoal needs itself lies beside it
    link = [f"-L{prefix / 'lib'}", "-lcoal", f"-Wl,-rpath,{prefix / 'lib'}"]
    link.append(f"-Wl,-rpath-link,{prefix / 'lib'}")
    # no -march: Eigen's alignment must be that of the library as it was built
    command = [compiler, "-O3", "-std=c++17", *include, str(SOURCE), "-o", str(program), *link]
    done = subprocess.run(command, capture_output=True, text=True, timeout=DEADLINE, check=False)
    if done.returncode:
        first = next((x for x in done.stderr.splitlines() if "error" in x), done.stderr[:200])
        raise OSError(f"it does not compile: {first}")
    return program


def _contender(pair: Pair, frames: Frames) -> Contender:
    scratch = tempfile.TemporaryDirectory()
    folder = Path(scratch.name)
    program, poses, answers = _built(folder), folder / "poses", folder / "answers"
    axes = np.array([list(solid.values.values()) for solid in (pair.a, pair.b)])
    both = np.stack([frames.poses_a, frames.poses_b], axis=1)[:, :, :3]
    poses.write_bytes(axes.tobytes() + np.ascontiguousarray(both).tobytes())

    def run(count: int) -> float:
        command = [str(program), str(poses), str(answers), str(count)]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        return float(done.stdout)

    def found(k: int) -> Found:
        row = np.fromfile(answers).reshape(-1, 7)[k - 1]
        return Found(row[0], row[1:4], row[4:])

    return Contender(NAME, run, found, len(frames.poses_a) - 1, keeps=scratch)
