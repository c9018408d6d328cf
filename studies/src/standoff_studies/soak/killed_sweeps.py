"""``python -m standoff_studies.soak.killed_sweeps JOB.toml``: a sweep or proof that is killed.

The job is run to its end once. Then, in another folder, the same command is begun again and again,
and something of it is killed at a random moment: the command itself, one of its two worker
processes, a worker of a cluster of Dask, or its scheduler. Where nothing was left to do some shards
are removed first. In the end all files must be the same bytes. On Linux alone: workers are found by
``/proc``.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from standoff.cli.terminal import tell

VICTIMS = ("command", "worker", "Dask worker", "scheduler")
PATIENCE = 300.0
"""Seconds for anything that is waited for."""
PAUSE = 0.01
TELL = 30.0
"""Seconds between two lines."""
LATEST = 0.5
"""Seconds after a new file at which something is killed, at the latest."""

Process = subprocess.Popen[bytes]


def begun(*command: str) -> Process:
    """A process in a group of its own."""
    return subprocess.Popen(
        command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
    )


def ended(process: Process) -> None:
    """Kill what is left of a process and its group."""
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def children_of(pid: int) -> list[int]:
    """Of a process on Linux: those that are workers, not those that watch over resources."""
    found = []
    for task in Path(f"/proc/{pid}/task").glob("*/children"):
        for child in map(int, task.read_text().split()):
            command = Path(f"/proc/{child}/cmdline").read_bytes()
            if b"spawn_main" in command:
                found.append(child)
    return found


def awaited(condition: Callable[[], bool], process: Process) -> bool:
    """Wait until a condition holds; False where a process ends before."""
    latest = time.monotonic() + PATIENCE
    while not condition():
        if process.poll() is not None:
            return False
        if time.monotonic() > latest:
            raise TimeoutError(f"{process.args!r} has not come so far in {PATIENCE:.0f} s")
        time.sleep(PAUSE)
    return True


@contextmanager
def cluster() -> Iterator[tuple[str, Process, Process]]:
    """A scheduler of Dask and a worker with two threads: (address, scheduler, worker)."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "scheduler.json"
        named = "--scheduler-file", str(file)
        dask = str(Path(sys.executable).with_name("dask"))
        scheduler = begun(dask, "scheduler", *named, "--no-dashboard", "--port", "0")
        awaited(lambda: file.exists() and file.read_text().rstrip().endswith("}"), scheduler)
        worker = begun(dask, "worker", *named, "--nthreads", "2", "--no-nanny", "--no-dashboard")
        try:
            yield str(json.loads(file.read_text())["address"]), scheduler, worker
        finally:
            ended(worker)
            ended(scheduler)


class Killed:
    """A folder in which a job is run, and killed."""

    def __init__(self, command: list[str], folder: Path, seed: int) -> None:
        self.command, self.folder = [*command, "-o", str(folder)], folder
        self.rng, self.count = random.Random(seed), Counter[str]()

    def shards(self) -> list[Path]:
        return sorted(self.folder.glob("shards/*.json"))

    def leave_some(self) -> None:
        """Remove a third of the shards where all is done."""
        report = self.folder / "report.json"
        if report.exists():
            shards = self.shards()
            for file in self.rng.sample(shards, max(1, len(shards) // 3)):
                file.unlink()
            report.unlink()

    def once(self, victim: str) -> None:
        """Begin the command, and kill something of it."""
        self.leave_some()
        if victim in VICTIMS[2:]:
            with cluster() as (address, scheduler, worker):
                command = begun(*self.command, "--cluster", address)
                self._kill(victim, command, scheduler if victim == "scheduler" else worker)
        else:
            command = begun(*self.command, "--workers", "2")
            self._kill(victim, command, command)

    def _kill(self, victim: str, command: Process, target: Process) -> None:
        before = len(self.shards())
        try:
            if not awaited(lambda: len(self.shards()) > before, command):
                self.count["too late"] += 1
                return
            time.sleep(self.rng.uniform(0.0, LATEST))
            workers = children_of(command.pid) if victim == "worker" else []
            if command.poll() is not None or (victim == "worker" and not workers):
                self.count["too late"] += 1
                return
            os.kill(self.rng.choice(workers) if workers else target.pid, signal.SIGKILL)
            self.count[victim] += 1
            if victim in ("worker", "scheduler"):  # the command ends by itself
                command.wait(PATIENCE)
        finally:
            ended(command)


def contents(folder: Path) -> dict[str, bytes]:
    return {
        str(file.relative_to(folder)): file.read_bytes()
        for file in sorted(folder.rglob("*"))
        if file.is_file()
    }


def main() -> int:
    """Run, kill, compare."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("job")
    parser.add_argument("--prove", help="clearance=LENGTH: a proof in place of the sweep")
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("-o", "--output", type=Path, required=True, help="a folder; it is emptied")
    given = parser.parse_args()
    shutil.rmtree(given.output, ignore_errors=True)
    given.output.mkdir(parents=True)
    standoff = str(Path(sys.executable).with_name("standoff"))
    command = [standoff, "sweep", given.job, *(["--prove", given.prove] if given.prove else [])]
    whole, folder = given.output / "whole", given.output / "killed"
    subprocess.run([*command, "-o", str(whole)], check=given.prove is None)
    killed, told = Killed(command, folder, given.seed), time.monotonic()
    while killed.count.total() - killed.count["too late"] < given.kills:
        killed.once(killed.rng.choice(VICTIMS))
        if time.monotonic() - told > TELL:
            told = time.monotonic()
            tell(str(dict(killed.count)))
    subprocess.run([*killed.command, "--workers", "2"], check=given.prove is None)
    same = contents(whole) == contents(folder)
    tell(f"killed: {dict(killed.count)}; {'the same bytes' if same else 'OTHER BYTES'}")
    return 0 if same else 1


if __name__ == "__main__":
    raise SystemExit(main())
