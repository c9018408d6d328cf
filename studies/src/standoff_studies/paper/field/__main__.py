"""Run the study: ``python -m standoff_studies.paper.field > summary.json``."""

import argparse

from standoff_studies.paper.field.methods import METHODS
from standoff_studies.paper.field.rows import FULL, as_json, study, works

if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        prog="python -m standoff_studies.paper.field",
        description="Run the methods of the field on the motions of simulations A to E and on "
        "drawn pairs, and print the rows as JSON. All of it takes three quarters of an hour, most "
        "of it interval Newton on the drawn pairs.",
    )
    parser.add_argument("--pairs", type=int, default=FULL.pairs, help="drawn pairs (default 1000)")
    parser.add_argument(
        "--boxes", type=int, default=FULL.boxes, help="those of them for interval Newton"
    )
    parser.add_argument("--starts", type=int, default=FULL.starts, help="starts of a simulation")
    parser.add_argument("--only", nargs="+", choices=list(METHODS), default=list(METHODS))
    given = parser.parse_args()
    size = FULL._replace(pairs=given.pairs, starts=given.starts)
    print(as_json(study(works(size), given.only, given.boxes)), end="")
