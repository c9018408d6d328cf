"""Whether the normals of a patch are within an open hemisphere."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from standoff.bodies.proofs.boxes import ROOT, DyadicBox
from standoff.bodies.proofs.forms import Forms
from standoff.bodies.proofs.tolerances import HEIGHT_ROUNDING
from standoff.geometry import bernstein
from standoff.typing import Array

# Boxes examined in one span before its normals count as not proven.
MOST_BOXES = 600
# Steps towards the axis of the smallest cone around the sampled normals: within 1/steps of it.
AXIS_STEPS = 200


def in_hemisphere(pieces: Sequence[Forms]) -> bool:
    """Do all normals make less than 90 degrees with one axis, proven by Bernstein bounds?"""
    axis = _axis(pieces)
    return axis is not None and all(_above(forms, axis) for forms in pieces)


def _axis(pieces: Sequence[Forms]) -> Array | None:
    """The axis of a nearly smallest cone around the normals at some points (Badoiu, Clarkson)."""
    t = np.linspace(0.0, 1.0, 5)
    normals = [bernstein.grid_values(f.normal, t, t).reshape(3, -1).T for f in pieces]
    cloud = np.concatenate(normals)
    lengths = np.linalg.norm(cloud, axis=1)
    regular = lengths > HEIGHT_ROUNDING * lengths.max(initial=0.0)
    if not regular.any():
        return None
    cloud = cloud[regular] / lengths[regular, None]
    axis: Array = cloud.mean(axis=0)
    for step in range(AXIS_STEPS):
        farthest = cloud[int((cloud @ axis).argmin())]
        axis = axis + (farthest - axis) / (step + 2.0)
    length = float(np.linalg.norm(axis))
    return axis / length if length > 0.0 else None


def _above(forms: Forms, axis: Array) -> bool:
    """Is axis @ normal positive over the patch, apart from its singular corners?"""
    heights = np.tensordot(axis, forms.normal, 1)
    floor = -HEIGHT_ROUNDING * float(np.abs(forms.normal).max())
    cells: list[DyadicBox] = [ROOT]
    count = 0
    while cells:
        cell = cells.pop()
        count += 1
        part = cell.part(heights)
        if part.min() > floor and part.max() > 0.0:
            continue
        if float(bernstein.value(part, 0.5, 0.5)) <= 0.0 or count > MOST_BOXES:
            return False
        bends_u, bends_v = (float(np.abs(np.diff(part, axis=k)).max()) for k in (0, 1))
        cells.extend(cell.halves(bends_u >= bends_v))
    return True
