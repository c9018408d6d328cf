"""Both solids with their minima in viser's scene."""

from __future__ import annotations

from typing import Any

import numpy as np

from standoff.bodies.features import Feature
from standoff.motion import Pose
from standoff.solids.answer import SolidProximity
from standoff.solids.spatial.solid_model import SolidModel
from standoff.view.picture import PairPicture
from standoff.view.solid_nodes import MinimaNodes
from standoff.view.solid_readout import solid_beside


class SolidPicture(PairPicture):
    """What a server shows of a pair of solids; all else in its scene is taken away.

    Parameters
    ----------
    server : viser.ViserServer
    solids : (SolidModel, SolidModel)
    unit : str
        Label of lengths.

    Attributes
    ----------
    glass : bool
        Whether both are as if of glass even where they do not overlap.
    """

    def __init__(self, server: Any, solids: tuple[SolidModel, SolidModel], unit: str) -> None:
        boundaries = solids[0].boundary, solids[1].boundary
        # Vertices would be taken for points of minima.
        super().__init__(server, boundaries, unit, corners=False)
        self._solids, self.glass = solids, True
        self._minima = MinimaNodes(server.scene, min(shape.size for shape in self.shapes))

    def show(
        self, answer: SolidProximity, poses: tuple[Pose, Pose], *, held: int | None = None
    ) -> None:
        """Draw an answer.

        Parameters
        ----------
        answer : SolidProximity
        poses : (Pose, Pose)
            That it was asked for.
        held : int, optional
            Number of the handle that is in a user's hand: it is left there.
        """
        deep = answer.penetrating and self._seen_into(answer.distance)
        for nodes in self._bodies:
            nodes.glass(deep or self.glass)
        told = (answer.feature_a, answer.feature_b)
        features = [part_shown(*each) for each in zip(self._solids, told, strict=True)]
        self._place(poses, (features[0], features[1]), np.nan_to_num(answer.normal))
        self._place_handles(poses, deep=deep, held=held)
        self._minima.show(answer, solid_beside(answer, self._unit, self.size))


def part_shown(solid: SolidModel, feature: Feature) -> Feature:
    """Return the face or edge of a solid's boundary that is active with a feature; none with a
    vertex, which is where the minimum's own point is drawn."""
    part = solid.part_told(feature) if feature.kind else feature
    return part if part.kind in ("face", "edge") else Feature("", 0)
