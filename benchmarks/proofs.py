"""Cells of a proof against the volume of the box, for 2 to 6 parameters.

Run from the repository's root: ``python -m benchmarks.proofs [--queries 2000000]``. Two ellipsoids,
one of which is shifted and turned. The sides of the box are scaled, which says how the cells grow
with its volume. Of each box the least distance that was seen in it, and the cells that prove a
share of that: the nearer to the truth, the more cells. Where the queries do not do, the share of
the box that is proven.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from standoff.robots.proof import Verdict
from standoff.sweep.job import Job
from standoff.sweep.parameters import in_ranges
from standoff.sweep.proof.proof import Proof
from standoff.sweep.proof.search import search
from standoff.sweep.proof.summary import Kind
from standoff.sweep.reading import load_job

Array = NDArray[np.float64]

SCENE = """version = 1
[bodies.a]
shape = "ellipsoid"
semi_axes = [3.0, 1.0, 0.8]
[bodies.b]
shape = "ellipsoid"
semi_axes = [2.0, 2.5, 1.5]
[placements.a]
position = [1.0, 0.5, {height}]
rotation_vector = [0.3, -0.2, 0.4]
[pair]
a = "a"
b = "b"
"""

PARAMETERS = (
    ("x", "x", 1.0),
    ("turn", "turn_y", 0.5),
    ("z", "z", 0.7),
    ("spin", "turn_z", 0.5),
    ("y", "y", 1.0),
    ("roll", "turn_x", 0.5),
)
HEIGHT = 6.0
SCALES = (0.5, 1.0, 1.5)
SHARES = (0.5, 0.9, 0.99)


def box_of(folder: Path, columns: int, scale: float) -> Job:
    """A job over the first parameters, each to both sides of 0."""
    (folder / "scene.toml").write_text(SCENE.format(height=HEIGHT))
    text = 'version = 1\nscene = "scene.toml"\n'
    for name, what, half in PARAMETERS[:columns]:
        ends = f"from = {-scale * half}\nto = {scale * half}\n"
        text += f'[parameters.{name}]\nmoves = "a"\nwhat = "{what}"\n{ends}'
    (folder / "job.toml").write_text(f'{text}[sampler]\nkind = "random"\nrows = 100_000\n')
    return load_job(folder / "job.toml")


def least_of(job: Job) -> float:
    """The least distance of 100,000 samples, and from there downhill."""
    rows = job.distances(0, 100_000)
    start = job.source.points(int(rows.distance.argmin()), int(rows.distance.argmin()) + 1)[0]

    def distance(point: Array) -> float:
        numbers = in_ranges(job.parameters, np.clip(point, 0.0, 1.0)[None])
        return float(job.pair.distances(job.parameters, numbers).distance[0])

    bounds = [(0.0, 1.0)] * len(start)
    return float(minimize(distance, start, method="Nelder-Mead", bounds=bounds).fun)


def main() -> None:
    """Print a row for each box."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--queries", type=int, default=2_000_000)
    given = parser.parse_args()
    print(
        "parameters  sides     least" + "".join(f"  {f'{share:.0%} of it':>22}" for share in SHARES)
    )
    for columns in range(2, len(PARAMETERS) + 1):
        for scale in SCALES:
            with tempfile.TemporaryDirectory() as folder:
                job = box_of(Path(folder), columns, scale)
            least, told = least_of(job), ""
            for share in SHARES:
                box = Proof(job, share * least).box
                box.finest = 1e-6
                began = time.thread_time()
                found = search(box, box.whole, given.queries, 5)
                taken = time.thread_time() - began
                proven = float(found.share(Kind.PROVEN))
                whole = f"{taken:.2g} s" if found.verdict is Verdict.PROVEN else f"{proven:.4%}"
                told += f"  {f'{found.queries}: {whole}':>22}"
            print(f"{columns:>10} {2.0 * scale:>6.1f} {least:>9.4f}{told}", flush=True)


if __name__ == "__main__":
    main()
