"""Spacing an aspheric lens by gradient: the thickness that leaves a wanted air gap.

The lens is plane behind and a conic of revolution in front. The next element is decentred, so the
gap is not on the axis; it is a proven distance, and so Newton's method ends at a proven gap. Run it
as `python lens_spacing.py`; it needs the extra `formulas`.
"""

import numpy as np

import standoff as so
from standoff.geometry import FormulaSurface

APERTURE = 6.0
"""Radius of the lens [mm]."""
WANTED = 0.4
"""Air gap to the next element [mm]."""
SAG = "c*v**2/(1 + sqrt(1 - (1 + k)*c**2*v**2))"
"""Of a conic of revolution with the vertex curvature c and the conic constant k."""


def lens(curvature, conic, thickness):
    """Plane behind, at z = 0; an asphere in front, whose vertex is at z = thickness."""
    domain = (0.0, 2.0 * np.pi, 0.0, APERTURE)
    ring = ("v*cos(u)", "v*sin(u)")
    front = FormulaSurface(
        *ring, f"h - {SAG}", domain, parameters={"c": curvature, "k": conic, "h": thickness}
    )
    rim = thickness - curvature * APERTURE**2 / (
        1.0 + np.sqrt(1.0 - (1.0 + conic) * (curvature * APERTURE) ** 2)
    )
    wall = FormulaSurface(
        f"{APERTURE}*cos(u)", f"{APERTURE}*sin(u)", "h*v", (0.0, 2.0 * np.pi, 0.0, 1.0),
        parameters={"h": rim},
    )  # fmt: skip
    back = FormulaSurface(*ring, "0", domain)
    return so.Body.from_patches([front, wall, back], name="lens")


def next_element():
    """A plano-convex lens, whose pole looks at the asphere."""
    return so.shapes.cap(radius=9.0, offset=7.5)


def spaced(design, other, space):
    """(answer, gradient) with the other element's centre at a height [mm], off the axis by 1 mm."""
    pose = so.Pose.exp([np.pi, 0.0, 0.0], [1.0, 0.0, space])
    answer = so.distance(design.body, other, so.Pose.identity(), pose)
    return answer, so.shape_gradient(answer, a=design)


def thickness_of(design, other, space, wanted=WANTED):
    """(design, steps): Newton's method on the centre thickness that leaves a wanted gap."""
    steps = []
    for _ in range(10):
        answer, found = spaced(design, other, space)
        steps.append((design.parameters["thickness"], answer.distance))
        if abs(answer.distance - wanted) <= 1e-10:
            return design, steps
        change = (answer.distance - wanted) / found.a["thickness"]
        design = design.changed(thickness=design.parameters["thickness"] - change)
    raise RuntimeError("The thickness was not found.")


def main():
    design = so.Design(lens, curvature=0.05, conic=-0.8, thickness=3.0)
    other = next_element()
    newton, steps = thickness_of(design.only("thickness"), other, space=12.6)
    for thickness, gap in steps:
        print(f"thickness {thickness:.9f} mm, gap {gap:.9f} mm")
    _, found = spaced(design.changed(**newton.parameters), other, 12.6)
    for name, rate in found.a.items():
        print(f"gap by {name}: {rate:+.6f}")


if __name__ == "__main__":
    main()
