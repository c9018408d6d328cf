"""The calls of a tracker that step many states at once."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from standoff.checks.real_numbers import shown

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from standoff.motion import PosesLike, TwistLike
    from standoff.tracking.answers import Answers
    from standoff.tracking.many_states import TrackerStates


class StepsMany:
    """A base of the tracker: many pairs of poses of its two bodies, frame after frame."""

    __slots__ = ()

    def start_many(
        self,
        poses_a: PosesLike,
        poses_b: PosesLike,
        twists_a: ArrayLike | TwistLike | None = None,
        twists_b: ArrayLike | TwistLike | None = None,
    ) -> TrackerStates:
        """Find the witness points of n pairs of poses globally, as ``start`` does.

        Raises TypeError, ValueError as ``start``.

        Parameters
        ----------
        poses_a, poses_b : array_like, shape (n, 4, 4) or (n, 12), and others, or one pose for all
            World poses, in any form that `distances` reads.
        twists_a, twists_b : array_like, shape (n, 6), or one twist for all, optional
            (v, omega) in world axes.

        Returns
        -------
        TrackerStates
        """
        from standoff.tracking.many_states import TrackerStates
        from standoff.tracking.runs import Frames, steps_of

        this: Any = self
        steps = steps_of(None, this.dt, this.check_frame_time)
        given = Frames.of(poses_a, poses_b, (twists_a, twists_b), steps)
        return TrackerStates.of([this.start(*given.frame(k)) for k in range(len(given.steps))])

    def step_many(
        self,
        states: TrackerStates,
        poses_a: PosesLike,
        poses_b: PosesLike,
        twists_a: ArrayLike | TwistLike | None = None,
        twists_b: ArrayLike | TwistLike | None = None,
        dt: ArrayLike | None = None,
        *,
        workers: int = 1,
    ) -> tuple[TrackerStates, Answers]:
        """One frame of n states in one compiled loop: each as ``step`` makes it.

        Between patches of ellipsoids frames are made in vectors; of these distance and bounds
        differ from those of ``step`` by 1e-13 of the size at most. All others are the same, to the
        last bit.

        Raises TypeError, ValueError as ``step``, with the number of the row; states of another
        pair, or of another number.

        Parameters
        ----------
        states : TrackerStates
            Of this pair; it is not changed.
        poses_a, poses_b : array_like, shape (n, 4, 4) or (n, 12), and others, or one pose for all
            World poses at the end of the step.
        twists_a, twists_b : array_like, shape (n, 6), or one twist for all, optional
            (v, omega) in world axes, as in ``step``.
        dt : float or array_like, shape (n,), optional
            Time since the frame before, s; the tracker's own if not given.
        workers : int
            Threads that share the rows; the answers are the same for any number.

        Returns
        -------
        (TrackerStates, Answers)
        """
        from standoff.errors import StandoffTypeError
        from standoff.tracking.many_states import TrackerStates, step_many
        from standoff.tracking.runs import Frames, steps_of

        this: Any = self
        if not isinstance(states, TrackerStates):
            raise StandoffTypeError(
                f"{shown(states)} is not TrackerStates: get them from tracker.start_many.",
                "states",
                states,
            )
        this.check_state(states[0])
        steps = steps_of(dt, this.dt, this.check_frame_time)
        given = Frames.of(poses_a, poses_b, (twists_a, twists_b), steps)
        return step_many(this, states, given.repeated(len(states)), workers)
