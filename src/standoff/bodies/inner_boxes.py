"""Rectangles of parameters inside a body's faces, where a frame need not check the boundary."""

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

    In a chart of an atlas, only as far as a witness point stays in that chart. None is sought in a
    face with holes, because it could contain a hole.
    """
    faces = [chart.face for chart in body.charts]
    shared = {face for face, n in Counter(faces).items() if n > 1}
    return [
        L.NO_INNER
        if body.charts[k].holed
        else inner_box(ints, reals, k, RECHART if face in shared else math.inf)
        for k, face in enumerate(faces)
    ]
