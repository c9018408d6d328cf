"""The tree of joints of a robot as arrays, read from its model.

Bounds of motion are taken from it. Poses are the package's own: a test holds the two together.
"""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

from standoff.typing import Array, Ints


class JointKind(IntEnum):
    """How a joint moves, and what of q it reads.

    FIXED reads nothing. HINGE reads an angle, rad, and SLIDE a length: both along ``axes``.
    CONTINUOUS is a hinge that reads (cos, sin). BALL reads a unit quaternion. FREE reads a position
    and a unit quaternion. GLIDE is a slide of a planar joint, whose velocity is given by two
    numbers in axes that turn with the joint: its speed is at most their length.
    """

    FIXED = 0
    HINGE = 1
    SLIDE = 2
    BALL = 3
    FREE = 4
    CONTINUOUS = 5
    GLIDE = 6


SLIDES = (JointKind.SLIDE, JointKind.GLIDE)
"""Those that read a length."""
SINGLE = (JointKind.HINGE, *SLIDES)
"""Those that read one number."""


class Joints(NamedTuple):
    """Joints in order from the root: the parent of each comes before it.

    The moved frame of a joint is ``moved[parent] @ placement @ motion(ratio q + offset)``. A joint
    of several motions, as a universal one, is several joints here.

    Attributes
    ----------
    names : tuple of str
    kinds : (nj,) array
        A `JointKind` each.
    parents : (nj,) array
        The joint before it; -1 for the world.
    placements : (nj, 4, 4) array
        The joint's frame, before it moves, in the moved frame of its parent.
    axes : (nj, 3) array
        Unit vectors of hinges and slides in the joint's own frame; 0 for the others.
    q_at, v_at : (nj,) arrays
        Where the joint's numbers begin in q (nq,) and in v (nv,).
    ratios, offsets : (nj,) arrays
        A hinge or slide is at ``ratio q[q_at] + offset``, a CONTINUOUS one at that angle of its
        (cos, sin): 1 and 0 but for joints that mimic another, and for models whose zero is
        elsewhere. The ratio of a CONTINUOUS one is whole: its angle is known to a turn.
    lower, upper : (nq,) arrays
        Limits of q; -inf and inf where there are none.
    scalar_first : bool
        Are quaternions in q (w, x, y, z)? If not they are (x, y, z, w).
    mimics : frozenset of int
        Numbers of the joints that read the number of another.
    """

    names: tuple[str, ...]
    kinds: Ints
    parents: Ints
    placements: Array
    axes: Array
    q_at: Ints
    v_at: Ints
    ratios: Array
    offsets: Array
    lower: Array
    upper: Array
    scalar_first: bool
    mimics: frozenset[int] = frozenset()

    def owner(self, i: int) -> int:
        """The joint that the number i of a configuration is of; none that mimics it."""
        own = [j for j in range(len(self.names)) if j not in self.mimics and self.q_at[j] <= i]
        return max(own, key=lambda j: int(self.q_at[j]))

    def chain(self, joint: int) -> list[int]:
        """The joints that move a joint's frame, itself included, from the root."""
        found = []
        while joint >= 0:
            found.append(joint)
            joint = int(self.parents[joint])
        return found[::-1]
