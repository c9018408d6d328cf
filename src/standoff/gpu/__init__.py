"""Cold rows and tracked frames on a GPU: the kernels' own functions, a thread to each row.

Needs the extra ``gpu``. See docs/gpu.md.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from standoff.on_demand import on_demand

if TYPE_CHECKING:
    from standoff.gpu.cold import distances
    from standoff.gpu.resources import Resources, resources_of
    from standoff.gpu.tracks import Tracks

__all__ = ["Resources", "Tracks", "distances", "resources_of"]

__getattr__, __dir__ = on_demand(
    __name__,
    {
        "standoff.gpu.cold": ("distances",),
        "standoff.gpu.tracks": ("Tracks",),
        "standoff.gpu.resources": ("Resources", "resources_of"),
    },
)
