"""Convexity of surfaces swept by a profile curve, from the proofs of the patches that they equal.

A rational profile rotated by at most a quarter turn, or moved along a direction, is a rational
Bezier patch; a surface swept by a profile given by a formula is given by a formula too.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from standoff.bodies.proofs import bernstein, interval
from standoff.bodies.proofs.forms import forms_of, with_poles
from standoff.bodies.proofs.normals import in_hemisphere
from standoff.bodies.proofs.proof import PatchProof
from standoff.bodies.proofs.tolerances import FLAT_PROFILE, WHOLE_ARCS
from standoff.errors import StandoffError, StandoffTypeError
from standoff.geometry.bernstein import segment
from standoff.geometry.curves import ConicArc, Curve, Line, RationalBezier
from standoff.geometry.formulas import FormulaCurve, FormulaSurface
from standoff.geometry.formulas.expressions import sympy_module
from standoff.geometry.nurbs import BezierPatch
from standoff.geometry.nurbs_curves import NurbsCurve
from standoff.geometry.swept import Extrusion, Revolution
from standoff.typing import Array

# Longest arc of one rational quadratic (radians): its weights stay well above zero.
LONGEST_ARC = 0.5 * np.pi
# Fractions of the domain's sides where the side to which a surface bulges is evaluated.
INNER = (0.125, 0.375, 0.625, 0.875)


def prove_swept(surface: Revolution | Extrusion, outward: int | None = None) -> PatchProof:
    """Prove that a swept surface is convex, or bound by how much it is not.

    Raises TypeError: a kind of profile without a proof. Raises ValueError: a profile that may be
    creased inside.

    Parameters
    ----------
    surface : finite in both parameters.
    outward : as in ``prove_patch``.
    """
    if isinstance(surface.profile, FormulaCurve):
        return interval.prove(_formula(surface, surface.profile), outward)
    proof = _proven(surface, outward, spare=False)
    if not proof.convex and _has_spare_knots(surface.profile):
        finer = _proven(surface, outward, spare=True)
        proof = finer if finer.convex else proof
    return proof


def _has_spare_knots(profile: Curve) -> bool:
    return isinstance(profile, NurbsCurve) and len(profile.spare_knots()) > 0


def _proven(surface: Revolution | Extrusion, outward: int | None, spare: bool) -> PatchProof:
    """As `prove_swept`, with pieces of the profile that also end at redundant knots if `spare`."""
    parts = _patches(surface, spare)
    patches = [patch for _, patch in parts]
    if outward is None:
        outward = _bulging(surface)
    proofs = [bernstein.prove(patch, outward or None) for patch in patches]
    worst = int(np.argmin([p.curvature for p in proofs]))
    low, high = surface.box()
    size = float(np.linalg.norm(high - low))
    # a path through several patches may turn back in each of them
    single = len(proofs) == 1
    defect = sum(p.defect + (0.0 if single else p.tilt * size) for p in proofs)
    return PatchProof(
        convex=all(p.convex for p in proofs),
        defect=min(defect, size),
        method="bernstein",
        hemisphere=_within_half(patches, low, high),
        place=_place(parts[worst][0], proofs[worst].place),
        sense=0 if all(p.sense == 0 for p in proofs) else outward,
        tilt=min(sum(p.tilt for p in proofs), float(np.pi)),
        curvature=min(p.curvature for p in proofs),
    )


def _bulging(surface: Revolution | Extrusion) -> int:
    """+1 or -1 as in ``PatchProof.sense``, the side to which the surface bulges more; 0 if flat.

    This is a choice, not a proof: the sign of the mean curvature, summed over some points.
    """
    u0, u1, v0, v1 = surface.domain
    total = most = 0.0
    for s in INNER:
        for t in INNER:
            _, xu, xv, xuu, xuv, xvv = surface.jet(u0 + s * (u1 - u0), v0 + t * (v1 - v0))
            normal = np.cross(xu, xv)
            e, f, g = float(xu @ xu), float(xu @ xv), float(xv @ xv)
            scale = float(np.linalg.norm(normal)) * (e * g - f * f)
            mean = float(normal @ (g * xuu - 2.0 * f * xuv + e * xvv)) / scale
            size = max(float(np.linalg.norm(xuu)) / e, float(np.linalg.norm(xvv)) / g)
            total, most = total + mean, max(most, size)
    return -int(np.sign(total)) if abs(total) > FLAT_PROFILE * most else 0


def _formula(surface: Revolution | Extrusion, profile: FormulaCurve) -> FormulaSurface:
    """The surface as a formula, in its own parameters."""
    sympy = sympy_module()
    u, v, t = sympy.symbols("u v t")

    def exact(a: Array) -> Any:
        return sympy.Matrix(np.vectorize(lambda x: sympy.Rational(float(x)), otypes=[object])(a))

    curve = exact(profile.linear) * sympy.Matrix(profile.formula.expressions)
    curve = curve + exact(profile.shift)
    if isinstance(surface, Revolution):
        radius, height = curve[0].subs(t, v), curve[2].subs(t, v)
        x, y, z = radius * sympy.cos(u), radius * sympy.sin(u), height
    else:
        x, y, z = curve.subs(t, u) + v * exact(surface.direction)
    whole = FormulaSurface(x, y, z, surface.domain)
    return whole.transformed(surface.linear, surface.shift)


Domain = tuple[float, float, float, float]


def _patches(surface: Revolution | Extrusion, spare: bool) -> list[tuple[Domain, BezierPatch]]:
    """Rational Bezier patches that together are the surface, each with its part of the domain."""
    u0, u1, v0, v1 = surface.domain
    found = []
    if isinstance(surface, Revolution):
        for arc in _arcs(u0, u1):
            across, weights = _arc_points(*arc)
            for first, last, h in rational_pieces(surface.profile, v0, v1, spare):
                # homogeneous: (r cos, r sin, z) of the tensor product
                x = across[:, None, 0] * h[None, :, 0]
                y = across[:, None, 1] * h[None, :, 0]
                z, w = (weights[:, None] * h[None, :, k] for k in (2, 3))
                found.append(((*arc, first, last), _patch(surface, np.stack([x, y, z, w], -1))))
        return found
    for first, last, h in rational_pieces(surface.profile, u0, u1, spare):
        moved = [h + np.append(v * surface.direction, 0.0) * h[:, 3:] for v in (v0, v1)]
        found.append(((first, last, v0, v1), _patch(surface, np.stack(moved, 1))))
    return found


def _patch(surface: Revolution | Extrusion, h: Array) -> BezierPatch:
    points = h[..., :3] / h[..., 3:]
    return BezierPatch(points @ surface.linear.T + surface.shift, h[..., 3])


def rational_pieces(
    curve: Curve, first: float, last: float, spare: bool = False
) -> list[tuple[float, float, Array]]:
    """(first, last, homogeneous Bezier points (p + 1, 4)) of the smooth pieces of a curve.

    spare : also cut at redundant knots of a spline.

    Raises TypeError: a kind of curve that is not rational. Raises ValueError: a knot where it may
    be creased.
    """
    if isinstance(curve, Line):
        ends = np.array([curve.point(first), curve.point(last)])
        return [(first, last, np.column_stack([ends, np.ones(2)]))]
    if isinstance(curve, ConicArc):
        found = []
        for a, b in _arcs(first, last):
            across, weights = _arc_points(a, b)
            basis = curve.basis()
            points = across @ basis[:, :2].T + weights[:, None] * basis[:, 2]
            found.append((a, b, np.column_stack([points, weights])))
        return found
    if isinstance(curve, RationalBezier):
        breaks, blocks = np.array([0.0, 1.0]), curve.data[1:].reshape(1, -1, 4)
    elif isinstance(curve, NurbsCurve):
        breaks, blocks = curve.essential.breaks, curve.blocks
        for knot in curve.breaks():
            if first < knot < last and curve.essential.multiplicity(knot) >= curve.degree:
                raise StandoffError(
                    f"The profile may be creased at its knot {knot}: split the surface there "
                    "(surface.restricted) and prove its parts."
                )
    else:
        raise StandoffTypeError(f"No convexity proof for a profile of {type(curve).__name__}.")
    extra = curve.spare_knots() if spare and isinstance(curve, NurbsCurve) else np.zeros(0)
    pieces = []
    for (a, b), block in zip(pairwise(breaks.tolist()), blocks, strict=True):
        inside = extra[(extra > max(a, first)) & (extra < min(b, last))]
        for low, high in pairwise([max(a, first), *inside.tolist(), min(b, last)]):
            if low < high:
                cut = segment(len(block) - 1, (low - a) / (b - a), (high - a) / (b - a))
                pieces.append((low, high, cut @ block))
    return pieces


def _arcs(first: float, last: float) -> list[tuple[float, float]]:
    count = int(np.ceil((last - first) / LONGEST_ARC * (1.0 - WHOLE_ARCS)))
    ends = np.linspace(first, last, max(count, 1) + 1)
    return [(float(a), float(b)) for a, b in pairwise(ends)]


def _arc_points(first: float, last: float) -> tuple[Array, Array]:
    """Weighted points (3, 2) of the unit circle's arc as a rational quadratic, and weights (3,)."""
    middle, weight = 0.5 * (first + last), np.cos(0.5 * (last - first))
    angles = np.array([first, middle, last])
    # the middle control point lies at 1 / weight: weighted, on the circle
    return np.column_stack([np.cos(angles), np.sin(angles)]), np.array([1.0, weight, 1.0])


def _place(domain: Domain, at: tuple[float, float]) -> tuple[float, float]:
    """A patch's place in [0, 1]^2 as parameters of the surface, to the accuracy of a search."""
    u0, u1, v0, v1 = domain
    return u0 + at[0] * (u1 - u0), v0 + at[1] * (v1 - v0)


def _within_half(patches: Sequence[BezierPatch], low: Array, high: Array) -> bool:
    centre, size = 0.5 * (low + high), float(np.linalg.norm(high - low))
    reach = float(np.maximum(np.abs(low), np.abs(high)).max()) / size
    forms = []
    for patch in patches:
        h = patch.spans()[0].points
        scaled = np.concatenate([(h[:3] - centre[:, None, None] * h[3:]) / size, h[3:]])
        forms.append(forms_of(with_poles(scaled)[0], reach))
    return in_hemisphere(forms)
