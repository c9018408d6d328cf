"""Fuzzing for long: ``python -m benchmarks.fuzz --minutes 10 --target scene``.

Targets, laws and corpus are those of ``tests/fuzz``. What breaks a law is added to the corpus,
which the suite replays; docs/fuzzing.md tells more. With ``--atheris`` the inputs follow coverage.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path
from random import Random
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
SILENCE = 180.0
"""Seconds without an input ended, after which the worker is taken to hang in compiled code."""
SECONDS = 10.0
"""Most seconds for one input; Python code is stopped there."""
TOLD = 100
"""Inputs between two summaries under Atheris."""
MEMORY = 8 << 30
"""Bytes of memory a worker may take."""
KERNELS = [
    ".".join(file.relative_to(ROOT / "src").with_suffix("").parts)
    for file in (ROOT / "src/standoff/kernels").rglob("*.py")
]
"""Modules whose coverage Atheris cannot follow: Numba would compile its marks too."""


def limit_memory() -> None:
    """Make too large an allocation a `MemoryError` of the library, which the laws see."""
    import resource

    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))


class Worker:
    """Draws and tries inputs in this process."""

    def __init__(self, name: str, current: Path) -> None:
        from fuzz.targets import TARGETS

        self.target = TARGETS[name]
        self.current = current
        self.counts: Counter[str] = Counter()
        self.places: set[str] = set()

    def attempt(self, name: str, content: bytes) -> None:
        """Try one input; the first that breaks a law at a place is kept."""
        from fuzz.laws import Broken, watchdog
        from fuzz.targets import check_once

        self.current.write_bytes(content)
        try:
            with watchdog(SECONDS):
                self.counts[check_once(self.target, name, content)] += 1
        except Broken as broken:
            self.counts["broken"] += 1
            place = str(broken).rsplit(" at ", 1)[-1][:80]
            if place not in self.places:
                self.places.add(place)
                print(f"{self.target.keep(name, content)}: {str(broken)[:500]}", flush=True)

    def run(self, seed: int, minutes: float) -> None:
        """Mutations of the corpus until the time is over."""
        random, corpus = Random(seed), self.target.corpus()
        end = time.monotonic() + 60.0 * minutes
        while time.monotonic() < end:
            self.attempt(*self.target.draw(corpus, random))

    def run_guided(self, seed: int, minutes: float) -> None:
        """The same, with Atheris choosing what is mutated next by the coverage it found."""
        import atheris

        corpus = self.target.corpus()
        name = "found.toml" if self.target.name == "scene" else "found.json"

        def mutate(data: bytes, most: int, number: int) -> bytes:
            inputs = {"input": data or b"{}", **corpus}
            return self.target.draw(inputs, Random(number))[1][:most]

        folder = tempfile.mkdtemp()
        for file, content in corpus.items():
            (Path(folder) / file).write_bytes(content)
        limits = [f"-max_total_time={int(60 * minutes)}", f"-seed={seed % 2**31}", "-max_len=20000"]
        limits.append(f"-artifact_prefix={folder}/")
        quiet = ["-verbosity=0", "-rss_limit_mb=0", "-timeout=0"]

        def attempt(data: bytes) -> None:
            self.attempt(name, data)
            if self.counts.total() % TOLD == 0:  # libFuzzer ends the process without a word
                print(self.summary(), flush=True)

        atheris.Setup([sys.argv[0], *limits, *quiet, folder], attempt, custom_mutator=mutate)
        atheris.Fuzz()

    def summary(self) -> str:
        told = ", ".join(f"{count} {word}" for word, count in self.counts.most_common())
        return f"{self.target.name}: {self.counts.total()} inputs: {told}"


def work(arguments: Any) -> int:
    """The worker's side."""
    sys.path.insert(0, str(ROOT / "tests"))
    limit_memory()
    if arguments.atheris:
        import atheris

        with atheris.instrument_imports(
            include=["standoff"], exclude=["standoff.kernels", *KERNELS]
        ):
            import fuzz.targets  # noqa: F401
    worker = Worker(arguments.target, Path(arguments.current))
    run = worker.run_guided if arguments.atheris else worker.run
    run(arguments.seed, arguments.minutes)
    print(worker.summary(), flush=True)
    return 1 if worker.counts["broken"] else 0


def watch(target: str, arguments: Any, seed: int, minutes: float) -> int:
    """Run a worker; one that is silent or dies leaves its last input in the corpus."""
    from fuzz.targets import TARGETS

    end = time.monotonic() + 60.0 * minutes
    worst = 0
    while (left := (end - time.monotonic()) / 60.0) > 0.05:
        current = Path(tempfile.mkdtemp()) / ("input.toml" if target == "scene" else "input.json")
        current.touch()
        command = [sys.executable, "-m", "benchmarks.fuzz", "--target", target, "--seed", str(seed)]
        command += ["--minutes", str(left), "--current", str(current)]
        command += ["--atheris"] if arguments.atheris else []
        process = subprocess.Popen(command, cwd=ROOT)
        while process.poll() is None:
            time.sleep(0.5)
            if time.time() - current.stat().st_mtime > SILENCE:
                process.kill()
                process.wait()
        if process.returncode in (0, 1):
            return max(worst, process.returncode)
        kept = TARGETS[target].keep(f"hang{current.suffix}", current.read_bytes())
        print(f"{kept}: the worker ended with {process.returncode}", flush=True)
        worst, seed = 1, seed + 1
    return worst


def main() -> int:
    """Fuzz; the exit code is 1 where a law was broken."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--target", default="all", help="scene, geometry, files or all")
    parser.add_argument("--minutes", type=float, default=10.0, help="for all targets together")
    parser.add_argument("--seed", type=int, help="default: a fresh one, which is told")
    parser.add_argument(
        "--atheris", action="store_true", help="coverage-guided: pip install atheris"
    )
    parser.add_argument("--current", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.seed is None:
        arguments.seed = int.from_bytes(os.urandom(4), "little")
    if arguments.current:
        return work(arguments)
    sys.path.insert(0, str(ROOT / "tests"))
    from fuzz.targets import TARGETS

    known = ["scene", "geometry"] if arguments.atheris else list(TARGETS)
    chosen = known if arguments.target == "all" else [arguments.target]
    if not set(chosen) <= set(known):
        parser.error(f"unknown target {arguments.target!r}: choose from {', '.join(known)} or all")
    print(f"seed {arguments.seed}", flush=True)
    share = arguments.minutes / len(chosen)
    return max(watch(name, arguments, arguments.seed, share) for name in chosen)


if __name__ == "__main__":
    sys.exit(main())
