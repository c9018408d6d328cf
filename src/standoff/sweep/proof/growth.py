"""Bodies that grow with their numbers: the largest and the smallest of a range, and how much they
grow along a direction."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from standoff.bodies.body import Body
from standoff.errors import StandoffError
from standoff.kernels.body import layout as L
from standoff.sweep.parameters import Parameter
from standoff.sweep.proof.extent import directions_for, supports
from standoff.sweep.proof.nesting import sense_of
from standoff.sweep.subjects.shaped_body import ShapedBody
from standoff.typing import Array

SIDE = 7
"""Directions along each side of a cube, as of `extent`: 294 in all, some 13 degrees apart, the axes
among them. They are for choosing what to halve, and prove nothing."""


class Growth:
    """How a body grows with the numbers of its shape.

    Raises StandoffError: a number of which the bodies do not nest.

    Parameters
    ----------
    shaped : ShapedBody
    parameters : sequence of Parameter
        All of the job.

    Attributes
    ----------
    columns : list of int
        Its own parameters.
    senses : list of float
        1 where the body of a greater number is the larger one, -1 where it is the smaller.
    largest : Body
        Of the whole range: it holds every other one, and its core the others' cores.
    """

    def __init__(self, shaped: ShapedBody, parameters: Sequence[Parameter]) -> None:
        self.columns = shaped.columns
        own = [parameters[k] for k in self.columns]
        self.senses = [_sense(shaped, p) for p in own]
        ends = [
            (p.low, p.high) if s < 0.0 else (p.high, p.low)
            for p, s in zip(own, self.senses, strict=True)
        ]
        large = [most + 0.0 for most, _ in ends]
        self.largest = shaped.made(tuple(large))
        self.directions = directions_for(self.largest, SIDE)[0]
        rates = []
        for k, (p, (_, least)) in enumerate(zip(own, ends, strict=True)):
            small = shaped.made((*large[:k], least + 0.0, *large[k + 1 :]))
            rates.append(self._grown(small) / (p.high - p.low))
        self.rates = np.array(rates)
        self.most = self.rates.max(axis=1)

    def _grown(self, small: Body) -> Array:
        """By how much the largest reaches farther than another along the directions."""
        if not self.largest.bounded:  # its own normal counts alone, along which numbers are lengths
            return np.full(len(self.directions), 1.0)
        far, near = (
            supports(body, self.directions) + float(body.reals[L.RADIUS])
            for body in (self.largest, small)
        )
        return np.maximum(0.0, far - near)

    def along(self, outward: Array) -> Array:
        """Return by how much the body reaches farther along normals (n, 3) in its own axes, for
        each unit of each of its numbers (n, k): about, and on the average over the range."""
        nearest = (outward @ self.directions.T).argmax(axis=1)
        found: Array = self.rates[:, nearest].T
        return found


def _sense(shaped: ShapedBody, parameter: Parameter) -> float:
    sense = sense_of(shaped.shape, parameter.what)
    if sense is None:
        raise StandoffError(
            f"parameters.{parameter.name}: a proof needs bodies of which the larger holds the "
            f"smaller, and those of a {shaped.shape} that differ in '{parameter.what}' do not "
            "nest: sweep it, or prove one value of it at a time",
            "job",
        )
    return sense
