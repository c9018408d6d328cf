"""Run the study anew and print its summary: ``python -m ...convergence > summary.json``."""

from standoff_studies.paper.convergence.cells import study, summary

if __name__ == "__main__":
    print(summary(study()), end="")
