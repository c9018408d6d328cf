"""Run the study anew and print its summary: ``python -m ...convergence > summary.json``."""

import argparse

from standoff_studies.paper.convergence.cells import study, summary

if __name__ == "__main__":
    argparse.ArgumentParser(
        prog="python -m standoff_studies.paper.convergence",
        description="Run the convergence study anew, some minutes, and print its summary as JSON.",
    ).parse_args()
    print(summary(study()), end="")
