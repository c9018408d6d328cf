"""Several local minima of one query, each followed by its own branch; the least one answers.

Only its follower knows what a branch's state is: a curve's parameter, a tracker's state, a pair of
patches. Here is what all have in common: which branches have come to one minimum, which begin and
end and why, and which is the least. The outcome does not depend on the order of the branches.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from enum import Enum
from typing import Generic, NamedTuple, TypeVar

from standoff.read_only import KeepsReadOnly

S = TypeVar("S")
Same = Callable[[S, S], bool]
"""Do two states stand at one minimum?"""

NONE = -1
"""In place of a key: no branch."""


class Birth(Enum):
    """Why a branch began."""

    START = "It was found where the query began."
    SEARCH = "A search of the frame showed a minimum that no branch followed."
    PROOF = "The proof of the least met a minimum that no branch followed."
    JUMP = "Another branch came to this minimum from the one that it followed."

    @property
    def sentence(self) -> str:
        """The reason in words."""
        return self.value


class End(Enum):
    """Why a branch ended."""

    MERGED = "It came to the minimum of another branch, which had moved less or was older."
    JUMPED = "It came to another minimum than the one that it followed."
    LEFT = "What it followed is no longer a local minimum."
    LOST = "Its value is no longer a number."
    FAR = "It is farther than is asked."
    MET = "The bodies meet, and no minima are followed there."

    @property
    def sentence(self) -> str:
        """The reason in words."""
        return self.value


class Branch(NamedTuple, Generic[S]):
    """One local minimum that is followed.

    Attributes
    ----------
    key : int
        Tells it from all other branches of the run.
    value : float
        What branches are compared by: the distance or the depth, in the unit of the query.
    state : object
        Where it stands.
    """

    key: int
    value: float
    state: S


class Change(NamedTuple):
    """A branch that has begun or ended in a frame.

    Attributes
    ----------
    key : int
        Of the branch.
    reason : Birth or End
    into : int
        Key of the branch that follows its minimum from now on, where it has MERGED or JUMPED;
        else -1.
    """

    key: int
    reason: Birth | End
    into: int = NONE


class BranchCounts(NamedTuple):
    """How many branches have begun and ended since the start, by the reasons `Birth` and `End`."""

    start: int = 0
    search: int = 0
    proof: int = 0
    jump: int = 0
    merged: int = 0
    jumped: int = 0
    left: int = 0
    lost: int = 0
    far: int = 0
    met: int = 0

    @property
    def born(self) -> int:
        """All that have begun."""
        return self.start + self.search + self.proof + self.jump

    @property
    def ended(self) -> int:
        """All that have ended."""
        return self.merged + self.jumped + self.left + self.lost + self.far + self.met

    def of(self, reason: Birth | End) -> int:
        """How many for one reason."""
        count: int = getattr(self, reason.name.lower())
        return count

    def with_one(self, reason: Birth | End) -> BranchCounts:
        """With one more for a reason."""
        return self._replace(**{reason.name.lower(): self.of(reason) + 1})


NO_COUNTS = BranchCounts()


class BranchPlace(NamedTuple, Generic[S]):
    """Where a branch has come to in a frame.

    Attributes
    ----------
    value : float
    state : object
    moved : float
        How far from where it was, in any one measure: of branches that have come to one minimum
        the one that has moved least stays.
    end : End or None
        JUMPED, if it has come to another minimum; LEFT, if it stands at none; else None.
    """

    value: float
    state: S
    moved: float = 0.0
    end: End | None = None


@dataclass(frozen=True, eq=False)
class Branches(KeepsReadOnly, Generic[S]):
    """The branches of one query, as a value: what changes them returns others.

    Attributes
    ----------
    branches : tuple of Branch
        By their keys.
    active : int
        Key of the one that answers; -1 before `settled`, and where there is none.
    next_key : int
        Of the next one that begins.
    changes : tuple of Change
        Of this frame, in their order.
    counts : BranchCounts
        Of all changes since the start.
    """

    branches: tuple[Branch[S], ...] = ()
    active: int = NONE
    next_key: int = 0
    changes: tuple[Change, ...] = ()
    counts: BranchCounts = NO_COUNTS

    def __iter__(self) -> Iterator[Branch[S]]:
        return iter(self.branches)

    def __len__(self) -> int:
        return len(self.branches)

    def of_key(self, key: int) -> Branch[S] | None:
        """The branch of a key, if it is still followed."""
        return next((b for b in self.branches if b.key == key), None)

    @property
    def least(self) -> Branch[S]:
        """The one that answers, of branches that are `settled` and not empty."""
        found = self.of_key(self.active)
        if found is None:
            raise LookupError("No branch is active: settle them first.")
        return found

    def known(self, state: S, same: Same[S]) -> Branch[S] | None:
        """The branch that stands at a state's minimum, if one does."""
        return next((b for b in self.branches if same(b.state, state)), None)

    def at_frame(self) -> Branches[S]:
        """As a frame begins: nothing has changed yet."""
        return replace(self, changes=())

    def joined(self, found: Iterable[tuple[float, S]], reason: Birth, same: Same[S]) -> Branches[S]:
        """With a branch for each value and state that none stands at; the first of equals begins.

        Raises ArithmeticError: a value that is not a number.
        """
        branches = self
        for value, state in found:
            if math.isnan(value):
                raise ArithmeticError("A branch cannot begin with a value that is not a number.")
            if branches.known(state, same) is None:
                branches = branches._born(value, state, reason)
        return branches

    def ended(self, keys: Iterable[int], reason: End) -> Branches[S]:
        """Without the branches of some keys."""
        branches = self
        for key in sorted(set(keys)):
            if branches.of_key(key) is not None:
                branches = branches._ended(key, reason)
        return branches

    def carried(self, follow: Callable[[Branch[S]], BranchPlace[S]], same: Same[S]) -> Branches[S]:
        """The branches in the next frame, each where its follower brings it.

        Of those that have come to one minimum, the one that has moved least stays, and the older
        of two that have moved alike. What has jumped goes on as a new branch, unless one is there
        already. Where the active branch merges, the one that it merges into is active.

        Parameters
        ----------
        follow : function
            From a branch to where it has come.
        same : function
            Of two states: do they stand at one minimum?
        """
        moved = [(branch.key, follow(branch)) for branch in self.branches]
        moved.sort(key=lambda pair: (pair[1].moved, pair[0]))
        after = replace(self, branches=(), changes=())
        ends, jumps = list[Change](), list[tuple[int, BranchPlace[S]]]()
        for key, new in moved:
            if math.isnan(new.value):
                ends.append(Change(key, End.LOST))
            elif new.end is End.JUMPED:
                jumps.append((key, new))
            elif new.end is not None:
                ends.append(Change(key, new.end))
            elif (there := after.known(new.state, same)) is not None:
                ends.append(Change(key, End.MERGED, there.key))
            else:
                after = after._with(Branch(key, new.value, new.state))
        for key, new in jumps:
            after = after.joined([(new.value, new.state)], Birth.JUMP, same)
            there = after.known(new.state, same)
            ends.append(Change(key, End.JUMPED, NONE if there is None else there.key))
        for change in sorted(ends, key=lambda change: change.key):
            after = after._told(change)
            if change.key == self.active:
                merged = change.reason is End.MERGED
                after = replace(after, active=change.into if merged else NONE)
        return after

    def settled(self, tie: float) -> Branches[S]:
        """With the least branch active: the one that is stays so, unless another is less by more.

        Parameters
        ----------
        tie : float
            By more than what another must be less, in the unit of the values.
        """
        least = min(self.branches, key=lambda b: (b.value, b.key), default=None)
        if least is None:
            return replace(self, active=NONE)
        held = self.of_key(self.active)
        keeps = held is not None and held.value <= least.value + tie
        return self if keeps else replace(self, active=least.key)

    def _with(self, branch: Branch[S]) -> Branches[S]:
        return replace(self, branches=tuple(sorted((*self.branches, branch), key=_key)))

    def _told(self, change: Change) -> Branches[S]:
        counts = self.counts.with_one(change.reason)
        return replace(self, changes=(*self.changes, change), counts=counts)

    def _born(self, value: float, state: S, reason: Birth) -> Branches[S]:
        key = self.next_key
        born = self._with(Branch(key, value, state))._told(Change(key, reason))
        return replace(born, next_key=key + 1)

    def _ended(self, key: int, reason: End) -> Branches[S]:
        left = tuple(b for b in self.branches if b.key != key)
        active = NONE if key == self.active else self.active
        return replace(self, branches=left, active=active)._told(Change(key, reason))


def _key(branch: Branch[S]) -> int:
    return branch.key
