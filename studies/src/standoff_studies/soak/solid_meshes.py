"""Points judged by OpenCASCADE's meshes: the generalised winding number, and the distance.

The winding number is the sum of the solid angles of all triangles over 4 pi (Van Oosterom and
Strackee 1983). It shares no geometry with the closed forms, and no code with the library.
"""

from __future__ import annotations

from math import atan2, inf, pi, sqrt

import numpy as np

from standoff_studies.soak.solid_forms import Array, compiled


@compiled
def dot(p, q):
    return p[0] * q[0] + p[1] * q[1] + p[2] * q[2]


@compiled
def solid_angle(a, b, c):
    """Of a triangle seen from the origin."""
    x, y, z = sqrt(dot(a, a)), sqrt(dot(b, b)), sqrt(dot(c, c))
    volume = a[0] * (b[1] * c[2] - b[2] * c[1])
    volume += a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    return 2.0 * atan2(volume, x * y * z + dot(a, b) * z + dot(b, c) * x + dot(c, a) * y)


@compiled
def to_segment(p, q):
    """The square of the distance of the origin from a segment."""
    e = (q[0] - p[0], q[1] - p[1], q[2] - p[2])
    size = dot(e, e)
    t = min(1.0, max(0.0, -dot(p, e) / size)) if size > 0.0 else 0.0
    x = (p[0] + t * e[0], p[1] + t * e[1], p[2] + t * e[2])
    return dot(x, x)


@compiled
def to_triangle(a, b, c):
    """The square of the distance of the origin from a triangle."""
    u = (b[0] - a[0], b[1] - a[1], b[2] - a[2])
    v = (c[0] - a[0], c[1] - a[1], c[2] - a[2])
    uu, uv, vv, ua, va = dot(u, u), dot(u, v), dot(v, v), -dot(u, a), -dot(v, a)
    area = uu * vv - uv * uv
    if area > 0.0:
        s, t = (ua * vv - va * uv) / area, (va * uu - ua * uv) / area
        if s >= 0.0 and t >= 0.0 and s + t <= 1.0:
            x = (a[0] + s * u[0] + t * v[0], a[1] + s * u[1] + t * v[1], a[2] + s * u[2] + t * v[2])
            return dot(x, x)
    return min(to_segment(a, b), to_segment(b, c), to_segment(c, a))


@compiled
def seen_from(corners, middles, points):
    """(n, 2): winding number of a mesh about each point, and the point's distance from it.

    Parameters are the triangles' corners (m, 9), and spheres around them (m, 4).
    """
    found = np.empty((len(points), 2))
    for k in range(len(points)):
        x, y, z = points[k, 0], points[k, 1], points[k, 2]
        angle, least = 0.0, inf
        for m in range(len(corners)):
            r = corners[m]
            a = (r[0] - x, r[1] - y, r[2] - z)
            b = (r[3] - x, r[4] - y, r[5] - z)
            c = (r[6] - x, r[7] - y, r[8] - z)
            angle += solid_angle(a, b, c)
            s = middles[m]
            far = sqrt((s[0] - x) ** 2 + (s[1] - y) ** 2 + (s[2] - z) ** 2) - s[3]
            if far <= 0.0 or far * far < least:
                least = min(least, to_triangle(a, b, c))
        found[k, 0], found[k, 1] = angle / (4.0 * pi), sqrt(least)
    return found


def windings_and_distances(triangles: Array, points: Array) -> tuple[Array, Array]:
    """Of points (n, 3) about a closed mesh (m, 3, 3): winding numbers and distances, (n,) each."""
    middles = triangles.mean(axis=1)
    radii = np.linalg.norm(triangles - middles[:, None], axis=2).max(axis=1)
    corners = np.ascontiguousarray(triangles.reshape(-1, 9))
    spheres = np.column_stack([middles, radii])
    found = np.asarray(seen_from(corners, spheres, np.ascontiguousarray(points)))
    return found[:, 0], found[:, 1]
