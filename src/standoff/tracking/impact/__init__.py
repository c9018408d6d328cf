"""The first time at which two bodies on given motions come to a given distance."""

from standoff.tracking.impact.answer import Impact, ImpactStatus
from standoff.tracking.impact.search import time_of_impact

__all__ = ["Impact", "ImpactStatus", "time_of_impact"]
