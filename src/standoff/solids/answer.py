"""The answer of two solids that need not be convex: a proven interval, and what it was found at."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.linalg import norm

from standoff.bodies.features import Feature
from standoff.bodies.plain_data import PlainData, plain, without_roundoff
from standoff.errors import StandoffError
from standoff.read_only import KeepsReadOnly
from standoff.tracking.derivatives import NOT_UNIQUE, Smoothness
from standoff.tracking.status import Status
from standoff.typing import Array

PointPair = tuple[Array, Array]
"""A point of A and one of B, world axes."""
NEAR_BOUNDS = 1.25
"""Times what is proven of a depth: if a translation no longer than this parts the solids, both
bounds are near enough to each other."""
MOST_OPEN = 64
"""Open pairs that an answer lists."""


class NearestPair(NamedTuple):
    """A local minimum of the distance between two boundaries.

    Attributes
    ----------
    distance : float
        Length; negative in an overlap, where moving B by -distance * normal parts this place.
    lower_bound : float
        Proven: no two points of the two pieces of boundary around it are closer; in an overlap of
        space these do not meet where B is moved by -lower_bound * normal. -inf: not proven.
    point_a, point_b : (3,) arrays
        World axes.
    normal : (3,) array
        Unit vector from A to B.
    feature_a, feature_b : Feature
    parameters_a, parameters_b : tuple of float
        As those of a `Proximity`.
    pieces : (str, str)
        Of compounds the pieces that the features are of, by name; empty for single bodies.
    patch : tuple of (point_a, point_b)
        With ``patch=``: up to four pairs that span where the boundaries are hardly farther apart,
        counterclockwise about the normal.
    key : int
        In frames of a tracker: distinguishes it from the other minima of the run, from frame to
        frame. -1 in a query, and where the solids meet.
    felt : bool
        False in a frame of a tracker for a place of overlap that did not come from above 0: another
        way out of a region that they overlap in already. Such places are told last, and the
        distance is of the others.
    """

    distance: float
    lower_bound: float
    point_a: Array
    point_b: Array
    normal: Array
    feature_a: Feature
    feature_b: Feature
    parameters_a: tuple[float, ...]
    parameters_b: tuple[float, ...]
    pieces: tuple[str, str] = ("", "")
    patch: tuple[PointPair, ...] = ()
    key: int = -1
    felt: bool = True


class Continuum(NamedTuple):
    """A set of nearest pairs that are all at the same distance.

    Attributes
    ----------
    kind : "line", "arc", "surface"
        What the witness points of one body fill.
    ends : tuple of (point_a, point_b)
        The pairs at its ends: two of a line or an arc, the corners found of a surface; none of a
        closed one.
    """

    kind: Literal["line", "arc", "surface"]
    ends: tuple[tuple[Array, Array], ...]


class Overlap(NamedTuple):
    """What is proven of two solids that overlap.

    Attributes
    ----------
    common_point : (3,) array
        Inside both if the radius is above 0, world axes.
    radius : float
        The ball of this radius round it is inside both; 0 where none was found.
    depth : float
        No translation shorter than this parts the solids: twice the radius, or more.
    parting : (3,) array, optional
        A vector, world axes: B, moved by it, is proven to be apart from A. In frames of a tracker,
        which ask nothing anew, one along which a plane comes between the solids.
    held : float
        No point of the boundary of one, in the other, is deeper in it than this: of a pin that is
        pressed into its bore, the interference. inf where that was not asked, or is not proven.
    """

    common_point: Array
    radius: float
    depth: float
    parting: Array | None = None
    held: float = np.inf

    @property
    def most(self) -> float:
        """How deep the overlap is at most: the length of `parting`, or `held` where that is less;
        inf where neither is known."""
        return min(self.held, self.way)

    @property
    def way(self) -> float:
        """The length of `parting`; inf where there is none."""
        return np.inf if self.parting is None else float(norm(self.parting))

    @property
    def reason(self) -> str:
        """Why what is told at least and at most of a depth is not one, in words; empty if it is."""
        if self.held < self.way < np.inf:
            return (
                f"held all round: neither boundary is deeper in the other than {self.held:.6g}, and"
                f" the shortest way out that was found is {self.way:.6g} long"
            )
        if NEAR_BOUNDS * self.depth < self.way < np.inf:
            return (
                f"no translation shorter than {self.depth:.6g} parts them, the shortest that is "
                f"found to is {self.way:.6g} long, and which is nearer to the least is not known"
            )
        return ""


class OpenPair(NamedTuple):
    """Two pieces of boundary of which a search could not prove what was asked.

    Attributes
    ----------
    lower_bound : float
        How far they are apart, at least, length; less than what was to be proven.
    feature_a, feature_b : Feature
        What the pieces belong to; none where a piece reaches over several.
    corners_a, corners_b : (n, 3) arrays
        Of a box around each piece, world axes: 8 in space, 4 in the plane, in the order of a
        binary count (z runs fastest).
    """

    lower_bound: float
    feature_a: Feature
    feature_b: Feature
    corners_a: Array
    corners_b: Array


class SolidCounts(NamedTuple):
    """What an answer took.

    Attributes
    ----------
    evaluations : int
        Of points and of bounds, which `deadline` limits: points of the boundaries (with their
        derivatives), pairs of boxes, and boxes of potentials, each counted once.
    node_pairs : int
        Pairs of boxes whose distance was bounded.
    leaf_pairs : int
        Pairs of pieces that had to be closed.
    boxes : int
        Boxes that potentials were bounded over.
    bisections : int
        Pieces that were cut in two because no potential closed them whole.
    open : int
        Pairs of pieces that were not closed; the answer lists the nearest of them.
    restarts : int
        Of a tracker's frame: 1 where it was asked from nothing.
    rebuilds : int
        Of a tracker's frame: 1 where the front of bounds was made anew.
    """

    evaluations: int = 0
    node_pairs: int = 0
    leaf_pairs: int = 0
    boxes: int = 0
    bisections: int = 0
    open: int = 0
    restarts: int = 0
    rebuilds: int = 0


@dataclass(frozen=True, eq=False, repr=False)
class SolidProximity(KeepsReadOnly, PlainData):
    """Witness points of two solids, and the interval in which their distance is proven to lie.

    All vectors are in world axes. The names are those of `Proximity`, where both have them.

    Attributes
    ----------
    status : Status
    distance : float
        Between the witness points while apart; of a solid inside the other's material the least
        wall between both boundaries; in an overlap that of the deepest place, below 0, where there
        is one (`minima`), within the bounds.
    lower_bound, upper_bound : float
        Proven: the true value of what ``distance`` stands for is neither less nor more. In an
        overlap no translation shorter than ``-upper_bound`` parts the solids, and one as long as
        ``-lower_bound`` does, or no boundary is deeper in the other (`Overlap.most`).
    slack : float
        How far the given boundaries may be from what they stand for, both together [length].
    point_a, point_b : (3,) arrays
    normal : (3,) array
        Unit vector from A to B.
    feature_a, feature_b : Feature
    parameters_a, parameters_b : tuple of float
    minima : tuple of NearestPair
        The pairs at the least distance, and with ``minima=`` all local ones below it, nearest
        first. The first is the answer's own.
    continuum : Continuum or None
        With the status CONTINUUM: the set of nearest pairs.
    overlap : Overlap or None
        With the status OVERLAPPING.
    inside : "A", "B" or ""
        Which solid is inside the other's material.
    cavity : "A", "B" or ""
        Which solid is in a closed cavity of the other, or in the plane in one of its holes, and
        not in its material: it cannot leave. With the status CONVERGED or CONTINUUM; of compounds
        it is said of the nearest pieces.
    open : tuple of OpenPair
        With the status WITHIN or DEADLINE: the pairs of pieces that are not closed, those with the
        least bound first and 64 at most; ``counts.open`` says how many there are. Where the
        boundaries meet, the pieces around the places at which they do.
    gradient_rows : (12,) array
        See `gradient`.
    smoothness : Smoothness
        SMOOTH where one pair is the nearest; ONE_SIDED at a tie, of which the gradient is that of
        the first pair; PARTIAL in a continuum, where only translations along the normal count;
        UNDEFINED where nothing is known.
    counts : SolidCounts
    poses : pair of (12,) arrays
        World poses of A and B for which the answer holds: R row-major, p.
    pieces : (str, str)
        Of compounds the nearest pieces, by name, of which the features are; empty for single
        bodies.
    """

    status: Status
    distance: float
    lower_bound: float
    upper_bound: float
    slack: float
    point_a: Array
    point_b: Array
    normal: Array
    feature_a: Feature
    feature_b: Feature
    parameters_a: tuple[float, ...]
    parameters_b: tuple[float, ...]
    minima: tuple[NearestPair, ...]
    continuum: Continuum | None
    overlap: Overlap | None
    inside: Literal["A", "B", ""]
    open: tuple[OpenPair, ...]
    gradient_rows: Array
    smoothness: Smoothness
    counts: SolidCounts
    poses: tuple[Array, Array]
    pieces: tuple[str, str] = ("", "")
    cavity: Literal["A", "B", ""] = ""

    @property
    def certified(self) -> bool:
        """Is what was asked proven to the tolerance?"""
        return self.status.certified

    @property
    def penetrating(self) -> bool:
        """Do the solids overlap?"""
        return self.status.penetrating

    @property
    def depth(self) -> float:
        """0 while apart, else a depth that no translation is less than."""
        return max(0.0, -self.distance)

    @property
    def unique(self) -> bool:
        """Are the witness points the only ones at the least distance?"""
        return self.smoothness is Smoothness.SMOOTH

    @property
    def gradient(self) -> Array:
        """(12,) derivative of the distance by the unit twists (v_A, omega_A, v_B, omega_B).

        At a tie it is that of the first pair, one-sided; see `smoothness`.

        Raises StandoffError where it is not defined.
        """
        if self.smoothness in (Smoothness.PARTIAL, Smoothness.UNDEFINED):
            raise StandoffError(
                f"The distance has no gradient here: {NOT_UNIQUE} `gradient_rows` has what is "
                "known of it, and `smoothness` says what that is."
            )
        return self.gradient_rows

    def carried(self, poses: tuple[Array, Array], doubt: float) -> SolidProximity:
        """Return the answer of the same solids, apart or touching, that were moved together.

        Parameters
        ----------
        poses : pair of (12,) arrays
            As the attribute.
        doubt : float
            No point of B has moved by more than this relative to A, length.
        """
        old, new = self.poses[0].reshape(4, 3), poses[0].reshape(4, 3)
        turn = new[:3] @ old[:3].T

        def at(points: Array) -> Array:
            return np.asarray((points - old[3]) @ turn.T + new[3])

        def pairs(given: tuple[PointPair, ...]) -> tuple[PointPair, ...]:
            return tuple((at(x), at(y)) for x, y in given)

        minima = tuple(
            each._replace(
                lower_bound=each.lower_bound - doubt, point_a=at(each.point_a),
                point_b=at(each.point_b), normal=turn @ each.normal, patch=pairs(each.patch),
            )
            for each in self.minima
        )  # fmt: skip
        left = tuple(OpenPair(bound - doubt, a, b, at(x), at(y)) for bound, a, b, x, y in self.open)
        ends = self.continuum and self.continuum._replace(ends=pairs(self.continuum.ends))
        return replace(
            self, lower_bound=self.lower_bound - doubt, upper_bound=self.upper_bound + doubt,
            point_a=at(self.point_a), point_b=at(self.point_b), normal=turn @ self.normal,
            minima=minima, continuum=ends, open=left, poses=poses,
            gradient_rows=(self.gradient_rows.reshape(4, 3) @ turn.T).ravel(),
            counts=SolidCounts(open=self.counts.open),
        )  # fmt: skip

    def as_dict(self) -> dict[str, Any]:
        """Return the answer as plain data, under the attributes' names."""
        facts = {field.name: plain(getattr(self, field.name)) for field in fields(self)}
        return facts | {"certified": self.certified}

    def __repr__(self) -> str:
        size = max(float(np.abs(self.point_a).max(initial=0.0)), abs(self.distance))
        shown = [self.distance, self.upper_bound - self.lower_bound]
        distance, gap = without_roundoff(shown, size)
        return (
            f"SolidProximity(distance={distance:.12g}, gap={gap:.2g}, "
            f"{self.feature_a} - {self.feature_b}, {self.status.name})"
        )
