"""Tests with the lowest and the highest Numba that `pyproject.toml` allows, in fresh environments.

Run from the repository's root: ``python -m benchmarks.numba_range``, or ``make numba-range``. Each
combination of an interpreter and a Numba gets a virtual environment of its own in a temporary
folder, an empty cache of kernels, all kernels compiled (``standoff warmup``) and the tests below:
ten to thirty minutes. By default the lowest and the highest Python that are declared are looked for
on PATH; one that is not there is told and not tried. ``--numba 0.69.0`` tries another version than
those that are allowed, so that the range can be widened after it.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
RANGE = re.compile(r">=(\d+)\.(\d+),<(\d+)(?:\.(\d+))?")
CONSTRAINTS = ROOT / "constraints.txt"
LOGS = ROOT / "build" / "numba-range"
PATIENCE = 3600
"""Seconds after which a test hangs: stock Numba compiles for minutes."""
FREE = ("numba", "llvmlite", "numpy")
"""What a Numba decides, so `constraints.txt` does not."""
PACKAGES = ("-e", ".[cli,test]", "-e", "./studies")
HOW = ("-q", "-p", "no:cacheprovider", "-o", f"faulthandler_timeout={PATIENCE}")
TESTS = (
    *("tests/kernels", "--ignore=tests/kernels/test_bounds_check.py", "tests/c_interface"),
    "tests/soak/test_checks.py",
    *("tests/bodies/test_bodies.py", "tests/bodies/test_taylor_proofs.py"),
    *("tests/geometry/test_formulas.py", "tests/geometry/test_surface_kinds.py"),
    *("tests/tracking/test_blocks.py", "tests/tracking/test_derivatives.py"),
    *("tests/tracking/test_exact_pairs.py", "tests/tracking/test_golden.py"),
    *("tests/tracking/test_laws.py", "tests/tracking/test_many_distances.py"),
    *("tests/tracking/test_no_frame_compiles.py", "tests/tracking/test_one_compile.py"),
    *("tests/tracking/test_penetration.py", "tests/tracking/test_routes.py"),
    *("tests/tracking/test_run.py", "tests/tracking/test_smooth_frame.py"),
    *("tests/simulation/test_golden_traces.py", "tests/servo"),
    "tests/paper/test_normals_system.py",
)
"""What compiles, calls or ships machine code, every group of entries, and what it answers."""


@dataclass(frozen=True)
class Tried:
    """What became of one combination."""

    python: str
    numba: str
    versions: str
    seconds: float
    outcome: str
    """"passed", or which step failed."""


def declared() -> tuple[str, str, list[int]]:
    """The lowest Numba, a specifier for all that are allowed, and the minor versions of Python."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    (numba,) = [each for each in project["dependencies"] if each.startswith("numba")]
    lowest = RANGE.search(numba)
    python = RANGE.fullmatch(project["requires-python"])
    if lowest is None or python is None or python[4] is None:
        raise ValueError(f"cannot read the ranges of {numba} and {project['requires-python']}")
    return f"{lowest[1]}.{lowest[2]}.0", numba, list(range(int(python[2]), int(python[4])))


def interpreters(minors: Sequence[int]) -> list[str]:
    """The lowest and the highest Python on PATH; tells which of the declared is not there."""
    found = {minor: f"python3.{minor}" for minor in minors if runs(f"python3.{minor}")}
    for minor in (minors[0], minors[-1]):
        if minor not in found:
            print(f"Python 3.{minor}: no interpreter python3.{minor} runs here; NOT TRIED")
    return [found[minor] for minor in sorted({min(found), max(found)})] if found else []


def runs(command: str) -> bool:
    """Is there such an interpreter? What a version manager puts on PATH may not run."""
    where = shutil.which(command)
    return where is not None and not subprocess.run([where, "-V"], capture_output=True).returncode


def tried(python: str, numba: str, folder: Path, log: Path) -> Tried:
    """Install into a new environment, compile everything, and test."""
    started = time.monotonic()
    bin_ = folder / "venv" / ("Scripts" if os.name == "nt" else "bin")
    free = re.compile(rf"(?:{'|'.join(FREE)})==")
    pins = [line for line in CONSTRAINTS.read_text("utf-8").splitlines() if not free.match(line)]
    (folder / "constraints.txt").write_text("\n".join(pins) + "\n", encoding="utf-8")
    pip = [str(bin_ / "python"), "-m", "pip", "--disable-pip-version-check", "install", "-q"]
    steps = {
        "environment": [python, "-m", "venv", str(folder / "venv")],
        # apart: a version that is not allowed yet is put in place of the one that is
        "installation": [*pip, "-c", str(folder / "constraints.txt"), *PACKAGES],
        "Numba": [*pip, numba],
        "warmup": [str(bin_ / "standoff"), "warmup"],
        "tests": [str(bin_ / "python"), "-m", "pytest", *HOW, *TESTS],
    }
    environment = {k: v for k, v in os.environ.items() if not k.startswith(("NUMBA_", "PYTHON"))}
    environment["NUMBA_CACHE_DIR"] = str(folder / "cache")
    (folder / "cache").mkdir(mode=0o700)
    failed = ""
    with log.open("w", encoding="utf-8") as out:
        for step, command in steps.items():
            print(f"  {step} ...", flush=True)
            done = subprocess.run(command, cwd=ROOT, env=environment, stdout=out, stderr=out)
            if done.returncode:
                failed = step
                break
    seconds = time.monotonic() - started
    outcome = f"FAILED in {failed}: see {log}" if failed else "passed"
    return Tried(python, numba, versions(bin_ / "python"), seconds, outcome)


def versions(python: Path) -> str:
    """Of Python, Numba, llvmlite and NumPy in an environment, as far as they are there."""
    code = (
        "import platform, importlib.metadata as m\n"
        "print(platform.python_version(), *(m.version(x) for x in ('numba', 'llvmlite', 'numpy')))"
    )
    done = subprocess.run([str(python), "-c", code], capture_output=True, text=True)
    return done.stdout.strip().replace(" ", ", ") or "not installed"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--python", action="append", help="interpreters, not those found on PATH")
    parser.add_argument("--numba", action="append", help="versions, not the ends of the range")
    parser.add_argument("-o", type=Path, default=LOGS, help="folder of the logs")
    options = parser.parse_args()
    lowest, allowed, minors = declared()
    numbas = [f"numba=={version}" for version in options.numba or [lowest]]
    numbas += [] if options.numba else [allowed]
    pythons = options.python or interpreters(minors)
    options.o.mkdir(parents=True, exist_ok=True)
    results: list[Tried] = []
    for python in pythons:
        for numba in numbas:
            print(f"{python}, {numba}", flush=True)
            log = options.o / f"{len(results)}.log"
            with tempfile.TemporaryDirectory() as folder:
                results.append(tried(python, numba, Path(folder), log))
    print("| Python, Numba, llvmlite, NumPy | minutes | |\n|---|---|---|")
    for each in results:
        print(f"| {each.versions} | {each.seconds / 60:.0f} | {each.outcome} |")
    return 0 if results and all(each.outcome == "passed" for each in results) else 1


if __name__ == "__main__":
    sys.exit(main())
