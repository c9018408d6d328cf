"""Triangles of faces: they cover each body's known area, and its normals point outward."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np
import pytest

import standoff as so
from standoff.bodies.tessellation import edge_lines, face_meshes

# body, its surface area
AREAS = [
    (so.shapes.box(1.0, 2.0, 3.0), 22.0),
    (so.shapes.cylinder(1.0, 2.0), 6 * pi),
    (so.shapes.cone(1.0, 2.0), pi * (1 + sqrt(5))),
    (so.shapes.ellipsoid(1.0, 1.0, 1.0), 4 * pi),
    (so.shapes.cap(1.0, -0.2), 2 * pi * 1.2 + pi * 0.96),
    (so.shapes.cap(1.0, 0.5), 2 * pi * 0.5 + pi * 0.75),
    (so.shapes.polytope([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]), 1.5 + sqrt(3) / 2),
]


@pytest.mark.parametrize(("body", "area"), AREAS, ids=lambda value: str(value)[:20])
def test_faces_are_covered_once(body: so.Body, area: float) -> None:
    meshes = face_meshes(body)
    centre = np.concatenate([mesh.points for mesh in meshes]).mean(axis=0)
    found = 0.0
    for mesh in meshes:
        a, b, c = np.moveaxis(mesh.points[mesh.triangles], 1, 0)
        across = np.cross(b - a, c - a)
        found += 0.5 * float(np.linalg.norm(across, axis=1).sum())
        normals = mesh.normals[mesh.triangles].mean(axis=1)
        assert (((a + b + c) / 3.0 - centre) * normals).sum(axis=1).min() > 0.0
        assert set(mesh.inner) <= set(range(len(mesh.points)))
    # Chords cut the curved parts by less than 2 %, and nothing is covered twice.
    assert 0.98 * area < found < area * (1 + 1e-9)


def test_edges_know_both_faces() -> None:
    for line in edge_lines(so.shapes.box(1.0, 2.0, 3.0)):
        assert line.normals.shape[0] == 2
        assert not line.smooth
        np.testing.assert_allclose(np.linalg.norm(line.normals, axis=2), 1.0, atol=1e-14)
        np.testing.assert_allclose((line.normals[0] * line.normals[1]).sum(axis=1), 0.0, atol=1e-14)
    (segment,) = edge_lines(so.shapes.segment(1.0))
    assert segment.normals.shape[0] == 0
