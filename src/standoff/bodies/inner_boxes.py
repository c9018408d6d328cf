"""Rectangles of parameters on a body's faces, in which a frame need not ask for the boundary."""

from __future__ import annotations

import math
from collections import Counter

from standoff.bodies.packing import Assembled, Ints
from standoff.geometry.validation import Array
from standoff.kernels.body import layout as L
from standoff.kernels.entries.queries import inner_box
from standoff.kernels.tolerances import RECHART


def inner_boxes(body: Assembled, ints: Ints, reals: Array) -> list[tuple[float, ...]]:
    """(u0, u1, v0, v1) of each chart, u0 > u1 where none was found.

    Of an atlas's chart only as far as a witness point stays in it; of a face with holes none is
    sought, as one might hold a hole.
    """
    faces = [chart.face for chart in body.charts]
    shared = {face for face, n in Counter(faces).items() if n > 1}
    return [
        L.NO_INNER
        if body.charts[k].holed
        else inner_box(ints, reals, k, RECHART if face in shared else math.inf)
        for k, face in enumerate(faces)
    ]
