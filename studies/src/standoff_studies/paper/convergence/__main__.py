"""Rerun the study: ``python -m ...convergence cells.jsonl > summary.json``."""

import argparse
from pathlib import Path

from standoff_studies.paper.convergence.cells import read, study, summary

if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        prog="python -m standoff_studies.paper.convergence",
        description="Run the convergence study, two hours of processor time, and print its "
        "summary as JSON. Cells that the file has already are not run again.",
    )
    parser.add_argument("cells", type=Path, help="where each cell and its traces are written")
    kept = parser.parse_args().cells
    study(kept)
    print(summary(read(kept.read_text("utf-8").splitlines())), end="")
