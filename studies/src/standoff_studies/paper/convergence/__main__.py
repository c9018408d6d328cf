"""Rerun the study: ``python -m ...convergence cells.jsonl > summary.json``.

``--harder cells.jsonl > harder.json`` reruns the other part.
"""

import argparse
from pathlib import Path

from standoff_studies.paper.convergence.cells import every_cell, harder_cells, read, study, summary
from standoff_studies.paper.convergence.harder import harder_summary

if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        prog="python -m standoff_studies.paper.convergence",
        description="Run the convergence study, two hours of processor time, and print its "
        "summary as JSON. Cells that the file has already are not run again.",
    )
    parser.add_argument("cells", type=Path, help="where each cell and its traces are written")
    parser.add_argument(
        "--harder", action="store_true", help="the cells with faster and sharper bodies instead"
    )
    given = parser.parse_args()
    study(given.cells, every=harder_cells if given.harder else every_cell)
    found = read(given.cells.read_text("utf-8").splitlines())
    print(harder_summary(found) if given.harder else summary(found), end="")
