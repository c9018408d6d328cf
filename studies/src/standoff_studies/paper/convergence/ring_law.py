"""The law on rings that bend inwards: a torus is one patch without sides, so nothing is switched.

Compiled, with the system's own equations from the library's kernels.
"""

from __future__ import annotations

import numpy as np

from standoff.kernels.algebra.rigid import read_rotation, read_vector
from standoff.kernels.algebra.vectors import cross, dot, norm, scale, sub
from standoff.kernels.body.features import moved_jet
from standoff.kernels.body.jets import torus_jet
from standoff.kernels.pair.system import (
    covariant_hessian,
    diagonal,
    gradient,
    hessian,
    projection_errors,
)
from standoff.kernels.values import Pose
from standoff_studies.own_kernels import own_kernel

PRINTED, COVARIANT, PARTS, GRADIENT = 0, 1, 2, 3
"""What stands for H: the printed one, the covariant one, that with the positive part of each
principal curvature, and the metric alone."""

RIDGE = 1e-12
"""Added to H in parts of its metric, so that a direction it does not see is left alone."""

ENOUGH = 1e-8
"""Slope at which a start has settled, |Ψ| by the tangents' lengths [length]."""


@own_kernel
def ring_jets(radii, pose, q):
    """The jets of ring A at home and of ring B at a pose; both radii 0 are a point."""
    a = torus_jet(radii, 0, q[0], q[1])
    b = torus_jet(radii, 2, q[2], q[3])
    return a, moved_jet(Pose(read_rotation(pose, 0), read_vector(pose, 9)), b)


@own_kernel
def positive_parts(away, jet):
    """away·II of a ring by its principal directions, u and v: each only where it is positive."""
    n = cross(jet[1], jet[2])
    square = dot(n, n)
    height = dot(away, n) / square if square > 0.0 else 0.0
    return max(height * dot(n, jet[3]), 0.0), max(height * dot(n, jet[5]), 0.0)


@own_kernel
def ring_form(jet_a, jet_b, law):
    """What a law takes for H, as an upper triangle."""
    if law == PRINTED:
        return hessian(jet_a, jet_b)
    if law == COVARIANT:
        return covariant_hessian(jet_a, jet_b)
    fu, fv, hr, hs = jet_a[1], jet_a[2], jet_b[1], jet_b[2]
    uu, vv = diagonal(dot(fu, fu), fu), diagonal(dot(fv, fv), fv)
    rr, ss = diagonal(dot(hr, hr), hr), diagonal(dot(hs, hs), hs)
    if law == GRADIENT:
        return uu, 0.0, 0.0, 0.0, vv, 0.0, 0.0, rr, 0.0, ss
    dR = sub(jet_a[0], jet_b[0])
    a_uu, a_vv = positive_parts(dR, jet_a)
    b_rr, b_ss = positive_parts(scale(-1.0, dR), jet_b)
    return (
        uu + a_uu,
        0.0,
        -dot(fu, hr),
        -dot(fu, hs),
        vv + a_vv,
        -dot(fv, hr),
        -dot(fv, hs),
        rr + b_rr,
        0.0,
        ss + b_ss,
    )


@own_kernel
def ring_system(radii, pose, q, law, g, form, lengths):
    """Write g, a law's H and the tangents' lengths; return |dR|."""
    jet_a, jet_b = ring_jets(radii, pose, q)
    slopes = gradient(projection_errors(jet_a, jet_b))
    entries = ring_form(jet_a, jet_b, law)
    k = 0
    for i in range(4):
        g[i] = slopes[i]
        for j in range(i, 4):
            form[i, j] = form[j, i] = entries[k]
            k += 1
    lengths[0], lengths[1], lengths[2], lengths[3] = (
        norm(jet_a[1]),
        norm(jet_a[2]),
        norm(jet_b[1]),
        norm(jet_b[2]),
    )
    return norm(sub(jet_a[0], jet_b[0]))


@own_kernel
def followed(radii, pose, q, law, step, stages, distances):
    """Follow a law from q, in place, step = K h: Heun with two stages, Euler with one.

    It ends when the slopes along the surfaces are below `ENOUGH`, or `distances` is full. Returns
    the frames it took; `distances` has the distance before each of them, and at the end.
    """
    frames = len(distances) - 1
    g, form, lengths = np.empty(4), np.empty((4, 4)), np.empty(4)
    first, other = np.empty(4), np.empty(4)
    for frame in range(frames):
        distances[frame] = ring_system(radii, pose, q, law, g, form, lengths)
        slope = 0.0
        for i in range(4):
            if lengths[i] > 0.0:
                slope = max(slope, abs(g[i]) / lengths[i])
                form[i, i] += RIDGE * lengths[i] ** 2
        if slope < ENOUGH:
            return frame
        first[:] = -step * np.linalg.solve(form, g)
        if stages == 2:
            other[:] = q + first
            ring_system(radii, pose, other, law, g, form, lengths)
            for i in range(4):
                form[i, i] += RIDGE * lengths[i] ** 2
            first[:] = 0.5 * (first - step * np.linalg.solve(form, g))
        for i in range(4):
            q[i] += first[i]
    distances[frames] = ring_system(radii, pose, q, law, g, form, lengths)
    return frames
