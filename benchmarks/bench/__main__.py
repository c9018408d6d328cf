"""``python -m benchmarks.bench``: the table beside other packages, printed and written.

``--quick`` gives a look in a minute; ``--worst 1000000`` the worst of so many frames instead.
"""

from __future__ import annotations

import argparse
import subprocess
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path

from benchmarks.bench import goals, library, limits, operations, report
from benchmarks.bench.motion import all_pairs
from benchmarks.bench.race import QUICK, Effort, Row, raced
from benchmarks.bench.worst import worst_frames

FOLDER = Path("build/bench")


def commit() -> str:
    """The commit of this checkout, with a sign where files differ from it."""
    found = subprocess.run(
        ["git", "describe", "--always", "--dirty", "--exclude=*"],
        capture_output=True,
        text=True,
        check=False,
    )
    return found.stdout.strip() or "unknown"


def facts(effort: Effort) -> dict[str, str]:
    """Machine, versions and what was asked."""
    peak, bandwidth = limits.peak(), limits.bandwidth()
    return {
        "commit": commit(),
        "date": datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        "processor": limits.processor(),
        "one core's peak of fused multiply-adds": f"{peak / 1e9:.1f} GFLOP/s",
        "one core's copy of memory": f"{bandwidth / 1e9:.1f} GB/s",
        "rounds": f"{effort.rounds}, contenders in turn",
        **limits.versions(),
    }


def reached(rows: list[Row]) -> dict[str, str]:
    """What a frame computes, and how much of the machine's peak that is."""
    cost, peak = operations.counted(), limits.peak()
    run = next(r for r in rows if r.pair == goals.ELLIPSOIDS and r.contender == library.RUN)
    rate = cost.operations / run.median
    return {
        "a frame of two ellipsoids": f"{cost.sums} sums, {cost.products} products, "
        f"{cost.divisions} divisions and roots; {cost.bytes_read} bytes read, "
        f"{cost.bytes_written} written",
        "of that peak, in `tracker.run`": f"{rate / 1e9:.1f} GFLOP/s, {100.0 * rate / peak:.1f} %",
    }


def told(known: dict[str, str]) -> list[str]:
    """The header of the page."""
    return ["| | |", "|---|---|", *(f"| {name} | {value} |" for name, value in known.items())]


def main(given: Sequence[str] | None = None) -> None:
    """Print and write the table."""
    reader = argparse.ArgumentParser(description="Times and errors beside other packages.")
    reader.add_argument("--quick", action="store_true", help="few frames: a minute or less")
    reader.add_argument("--worst", type=int, metavar="N", help="the worst of N frames instead")
    reader.add_argument("-o", "--out", type=Path, default=FOLDER, help="folder of the files")
    asked = reader.parse_args(given)
    if asked.worst:
        print(worst_frames(asked.worst))
        return
    effort = QUICK if asked.quick else Effort()
    rows: list[Row] = []
    doubts: dict[str, float] = {}
    for pair in all_pairs():
        found, doubts[pair.name] = raced(pair, effort)
        rows += found
    known = facts(effort) | reached(rows)
    text = report.markdown(told(known), rows, doubts)
    print(text)
    for path in report.write(asked.out, text, rows, known):
        print(f"wrote {path}")


if __name__ == "__main__":
    main()
