"""The field that the paper compares itself with, on the same work: cost, accuracy, failures."""

from standoff_studies.paper.field.figures import as_committed

__all__ = ["as_committed"]
