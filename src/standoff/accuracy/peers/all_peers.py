"""The peers of the report."""

from __future__ import annotations

from standoff.accuracy.peers.answer import Peer
from standoff.accuracy.peers.coal_peer import Coal
from standoff.accuracy.peers.fcl_peer import Fcl
from standoff.accuracy.peers.mujoco_peer import MuJoCo
from standoff.accuracy.peers.opencascade_peer import OpenCascade


def all_peers() -> tuple[Peer, ...]:
    """Return every package at every setting; each is imported when it is first asked."""
    return Coal(), Coal(tight=True), MuJoCo(), MuJoCo(tight=True), Fcl(), OpenCascade()
