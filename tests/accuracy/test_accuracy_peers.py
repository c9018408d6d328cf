"""Every peer keeps Standoff's conventions for every shape it has."""

import sys

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from standoff_studies.accuracy.measuring import errors
from standoff_studies.accuracy.peers.all_peers import all_peers
from standoff_studies.accuracy.peers.coal_peer import Coal
from standoff_studies.accuracy.peers.fcl_peer import Fcl, _outward_triangles
from standoff_studies.accuracy.peers.mujoco_peer import MuJoCo
from standoff_studies.accuracy.peers.opencascade_peer import OpenCascade
from standoff_studies.accuracy.solids import KINDS

ACCURACY = (1e-3, 5e-2, 0.2)
"""What every peer reaches of distance, witness points and normal: conventions show, not digits."""

PARTNER = {"OpenCASCADE": "NURBS ellipsoid"}
"""The shape that every other is paired with; a sphere but for this peer."""

MISSING = {
    "Coal, default": {"NURBS ellipsoid", "superellipsoid", "creased superellipsoid", "egg", "cap"}
    | {"lens", "spindle", "gore", "torus hull"},
    "MuJoCo, default": {"point", "segment", "NURBS ellipsoid", "superellipsoid", "egg", "cone"}
    | {"creased superellipsoid", "cap", "lens", "spindle", "gore", "torus hull"}
    | {"rounded box", "polytope", "rounded polytope"},
    "python-fcl": {"point", "segment", "NURBS ellipsoid", "superellipsoid", "egg", "halfspace"}
    | {"creased superellipsoid", "cap", "lens", "spindle", "gore", "torus hull"}
    | {"rounded box", "rounded polytope"},
    "OpenCASCADE": {kind.name for kind in KINDS}
    - {"NURBS ellipsoid", "sphere", "cylinder", "cone", "box"},
}
MISSING |= {f"{name}, tight": MISSING[f"{name}, default"] for name in ("Coal", "MuJoCo")}


@pytest.mark.parametrize("peer", all_peers(), ids=lambda peer: peer.name)
def test_conventions_of_every_shape(peer, cases_of, solids) -> None:
    partner = PARTNER.get(peer.name, "sphere")
    missing = set()
    for kind in KINDS:
        if peer.query(solids[kind.name][0], solids[partner][0]) is None:
            missing.add(kind.name)
            continue
        for case in cases_of(partner, kind.name, 2):
            if abs(case.level) < 0.1 or not (case.level > 0 or peer.overlaps):
                continue
            if not case.constructed:
                continue
            found = peer.query(case.a, case.b)(case.truth.pose_a, case.truth.pose_b)
            assert np.all(np.array(errors(case, found)) <= ACCURACY), (kind.name, case.truth)
    assert missing == MISSING[peer.name]


@pytest.mark.parametrize(
    ("peer", "package"),
    [(Coal(), "coal"), (MuJoCo(), "mujoco"), (Fcl(), "fcl"), (OpenCascade(), "OCP.BRepExtrema")],
)
def test_a_missing_peer_names_the_extra(monkeypatch, peer, package, solids) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(ImportError, match=rf"{package} .*standoff-studies\[peers\]"):
        peer.query(solids["sphere"][0], solids["NURBS ellipsoid"][0])


def test_triangles_of_a_hull_are_seen_from_outside(solids) -> None:
    for solid in solids["polytope"]:
        vertices = solid.values["vertices"]
        triangles = vertices[_outward_triangles(vertices)]
        volume = np.linalg.det(triangles - vertices.mean(axis=0)).sum() / 6
        assert volume == pytest.approx(ConvexHull(vertices).volume)


def test_versions_are_known() -> None:
    assert all(peer.version[0].isdigit() for peer in all_peers())
