"""Bodies of curves, patches and formulas, from the parameters that the tests differentiate by."""

import numpy as np

import standoff as so
from standoff.geometry import BezierPatch, ConicArc, FormulaSurface, Torus

FULL_TURN = 2.0 * np.pi


def gore(radius, height):
    return so.shapes.gore(radius, height, patches=4)


def wheel(major, minor, tall):
    return so.shapes.hull_of_revolution(ConicArc([major, 0, 0], [minor, 0, 0], [0, 0, tall]))


def arch(control, weight, depth):
    """Control points (3, 2) of a rational parabola in the plane y = 0, swept along y."""
    bow = np.insert(np.asarray(control), 1, 0.0, axis=1)
    chord = np.array([bow[0], 0.5 * (bow[0] + bow[2]), bow[2]])
    weights, across = np.array([1.0, weight, 1.0]), np.array([0.0, 0.5 * depth, 0.0])
    both = np.stack([weights, weights], axis=1)
    caps = [
        BezierPatch(
            np.stack([bow + side, chord + side], axis=1), np.stack([weights, np.ones(3)], 1)
        )
        for side in (across, -across)
    ]
    back = BezierPatch(np.stack([bow - across, bow + across], axis=1), both)
    base = BezierPatch(np.stack([chord[[0, 2]] - across, chord[[0, 2]] + across], axis=1))
    return so.Body.from_patches([back, base, *caps], name="arch")


def dome(height):
    domain = (0.0, FULL_TURN, 0.0, 1.0)
    ring = ("v*cos(u)", "v*sin(u)")
    top = FormulaSurface(*ring, "h*(1 - v**2)/2", domain, parameters={"h": height})
    return so.Body.from_patches([top, FormulaSurface(*ring, "0", domain)], name="dome")


def ring(major, minor):
    """A torus: a boundary, without a solid's search for where it crosses itself."""
    return so.bodies.Boundary.from_patches([Torus(major, minor, v0=-np.pi, v1=np.pi)], name="ring")
