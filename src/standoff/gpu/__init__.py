"""Cold rows and tracked frames on a GPU: the kernels' own functions, a thread to each row.

Needs the extra ``gpu``; loaded by its own name alone. See docs/gpu.md.
"""

from standoff.gpu.cold import distances
from standoff.gpu.resources import Resources, resources_of
from standoff.gpu.tracks import Tracks

__all__ = ["Resources", "Tracks", "distances", "resources_of"]
