"""The peers of the report."""

from __future__ import annotations

from standoff_studies.accuracy.peers.answer import Peer
from standoff_studies.accuracy.peers.coal_peer import Coal
from standoff_studies.accuracy.peers.fcl_peer import Fcl
from standoff_studies.accuracy.peers.mujoco_peer import MuJoCo
from standoff_studies.accuracy.peers.opencascade_peer import OpenCascade


def all_peers() -> tuple[Peer, ...]:
    """Return every package at every setting; each is imported when it is first asked."""
    return Coal(), Coal(tight=True), MuJoCo(), MuJoCo(tight=True), Fcl(), OpenCascade()
