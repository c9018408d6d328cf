"""The answer of one pair of a robot's geometries, with its gradient by the joints."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from standoff.read_only import KeepsReadOnly
from standoff.tracking.derivatives import Smoothness
from standoff.tracking.status import Status
from standoff.typing import Array
from standoff.world.pair_answer import PairAnswer

if TYPE_CHECKING:
    from standoff.world.solid_answer import SolidPairAnswer


class Flag(NamedTuple):
    """Whether a row is the derivative of its distance.

    Attributes
    ----------
    smoothness : Smoothness
        By the motions of the two bodies.
    reason : str
    smooth : bool
        By the robot's velocity: turns without a derivative may be such as no joint makes.
    """

    smoothness: Smoothness
    reason: str
    smooth: bool


class Signed(Protocol):
    """Rows of signed distances, which can tell whether each has a derivative."""

    @property
    def distance(self) -> Array: ...

    @property
    def lower_bound(self) -> Array: ...

    @property
    def upper_bound(self) -> Array: ...

    @property
    def normal(self) -> Array: ...

    def flag(self, k: int) -> Flag: ...


class RobotAnswer(KeepsReadOnly):
    """Witness points of two geometries of a robot, their distance, and its gradient by the joints.

    Attributes
    ----------
    names, links : (str, str)
        Of the geometries, and of the links that carry them: A and B. The link of an obstacle is the
        obstacle.
    distance, lower_bound, upper_bound : float
        Signed, length; as of `RobotRows`.
    point_a, point_b, normal : (3,) arrays
        World axes; the normal points from A to B.
    gradient : (nv,) array
        Of the distance by the robot's velocity, length per unit of it: by rad or length of a joint.
        It always has numbers: where the distance has no derivative they are those of these witness
        points, and `smooth` is False.
    smoothness : Smoothness
        As of a pair's derivatives: ONE_SIDED has a gradient that holds on all sides.
    reason : str
        Why it is not smooth; empty if it is.
    smooth : bool
        Is the gradient the derivative by every joint?
    status : Status
    certified : bool
    clearance : float
        A proven lower bound of the distances of *all* pairs that are watched, length.
    pair : PairAnswer or SolidPairAnswer
        All else that is known of the pair.
    """

    __slots__ = ("_k", "_rows", "clearance", "gradient", "links", "names", "pair")

    def __init__(
        self,
        pair: PairAnswer | SolidPairAnswer,
        links: tuple[str, str],
        gradient: Array,
        clearance: float,
        row: tuple[Signed, int],
    ) -> None:
        self.pair, self.names, self.links = pair, pair.names, links
        self.gradient, self.clearance = gradient, clearance
        self._rows, self._k = row

    @property
    def distance(self) -> float:
        return float(self._rows.distance[self._k])

    @property
    def lower_bound(self) -> float:
        return float(self._rows.lower_bound[self._k])

    @property
    def upper_bound(self) -> float:
        return float(self._rows.upper_bound[self._k])

    @property
    def point_a(self) -> Array:
        return self.pair.point_a

    @property
    def point_b(self) -> Array:
        return self.pair.point_b

    @property
    def normal(self) -> Array:
        normal: Array = self._rows.normal[self._k]
        return normal

    @property
    def status(self) -> Status:
        return self.pair.status

    @property
    def certified(self) -> bool:
        return self.pair.certified

    @property
    def smoothness(self) -> Smoothness:
        return self._rows.flag(self._k).smoothness

    @property
    def reason(self) -> str:
        return self._rows.flag(self._k).reason

    @property
    def smooth(self) -> bool:
        return self._rows.flag(self._k).smooth

    def as_dict(self) -> dict[str, Any]:
        """Plain data: that of the pair, with the links and the gradient."""
        more = {"links": list(self.links), "gradient": self.gradient.tolist()}
        signed = {name: getattr(self, name) for name in ("distance", "lower_bound", "upper_bound")}
        signed |= {"normal": self.normal.tolist(), "clearance": self.clearance}
        return self.pair.as_dict() | more | signed

    def __repr__(self) -> str:
        a, b = self.names
        return f"RobotAnswer({a!r}, {b!r}, distance={self.distance:.12g}, {self.status.name})"
