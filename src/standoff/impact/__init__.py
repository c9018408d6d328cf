"""The first time at which two moving bodies meet."""

from typing import TYPE_CHECKING

from standoff.on_demand import on_demand

if TYPE_CHECKING:
    from standoff.impact.answer import Impact, ImpactStatus
    from standoff.impact.query import time_of_impact
else:
    __getattr__, __dir__ = on_demand(__name__)

__all__ = [
    "Impact",
    "ImpactStatus",
    "time_of_impact",
]
