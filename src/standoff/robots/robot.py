"""A robot: exact bodies on the links of a model, which pairs are watched, and its obstacles."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from standoff.checks.arrays import finite_rows
from standoff.checks.numbers import positive, whole_number
from standoff.checks.real_numbers import shape_of
from standoff.errors import StandoffError
from standoff.robots.answer import RobotAnswer
from standoff.robots.batch import RobotAnswers
from standoff.robots.certify_tolerances import ASKED_CLEARANCE
from standoff.robots.kinematics import Kinematics
from standoff.robots.loaded import Loaded
from standoff.robots.obstacles import read_obstacles
from standoff.robots.proof import BoxProof, PathProof
from standoff.robots.robot_model import RobotModel
from standoff.robots.rows import RobotRows
from standoff.robots.state import RobotState
from standoff.tracking.threads import in_parts
from standoff.typing import Array

if TYPE_CHECKING:
    from standoff.robots.robot_page import RobotPage

Meshes = Any
"""None, "hull", or a mapping of names of geometries to "hull", a Body or a Compound."""


class Robot(RobotModel):
    """A robot model with exact bodies: distances of its pairs, and gradients by its joints.

    Made by `from_mujoco`, `from_pinocchio` or `from_urdf`. Kinematics are the package's own;
    configurations and velocities are in its conventions. Immutable.

    Attributes
    ----------
    nq, nv : int
        Numbers of a configuration, and of a velocity.
    joints : Joints
        The tree of joints as arrays.
    geoms : Geoms
        The geometries, obstacles last, in the order of the world.
    pairs : list of (str, str)
        Names of the geometries of all pairs that are watched.
    world : World
        The bodies, with the robot's horizon.
    kinematics : Kinematics
    lower, upper : (nq,) arrays
        Limits of q; -inf and inf where there are none. Distances exist beyond them too: a
        configuration outside is answered, and ``outside`` names its joints.
    within : float
        The horizon of ``distances``, ``start`` and ``step``, length.
    obstacles : dict of str to (body, Pose)
    loaded : Loaded
        What was read from the model.
    """

    @staticmethod
    def from_mujoco(
        model: Any,
        *,
        meshes: Meshes = None,
        skip: Sequence[str] = (),
        within: float | None = None,
        obstacles: Mapping[str, Any] | None = None,
    ) -> Robot:
        """A robot of a MuJoCo model.

        Its pairs are those that MuJoCo's collision detection would take: by ``contype`` and
        ``conaffinity``, without parent and child, ``<exclude>`` and bodies that are welded
        together, and with each ``<pair>``.

        Raises ModuleNotFoundError: MuJoCo is not installed; the message names the extra. Raises
        TypeError: no model. Raises ValueError: geometries that have no exact body, by name, with
        what to do: meshes without `meshes`, height fields, signed distance functions; flexible
        bodies; names that nobody has.

        Parameters
        ----------
        model : mujoco.MjModel, str or path
            A model, or the path of an MJCF or URDF file that MuJoCo reads.
        meshes : None, "hull" or mapping of str to ("hull", Body, Solid or Compound)
            What stands for meshes: their hulls, or what is given by the geometries' names, in the
            frame of the geometry. Without it a mesh is refused.
        skip : list of str
            Names of geometries or of links that are left out, with all their pairs.
        within : float, optional
            The horizon, length: of pairs farther apart only that is proven. All distances if not
            given.
        obstacles : mapping of str to (Body, Solid or Compound, pose), optional
            As for ``with_obstacles``.

        Returns
        -------
        Robot
        """
        from standoff.robots.mujoco import load

        return _made(load(model, meshes, skip), within, obstacles)

    @staticmethod
    def from_pinocchio(
        model: Any,
        geometry_model: Any,
        *,
        meshes: Meshes = None,
        skip: Sequence[str] = (),
        within: float | None = None,
        obstacles: Mapping[str, Any] | None = None,
    ) -> Robot:
        """A robot of a Pinocchio model and its collision model.

        Its pairs are ``geometry_model.collisionPairs``.

        Raises ModuleNotFoundError: Pinocchio is not installed; the message names the extra. Raises
        TypeError: no models. Raises ValueError: geometries that have no exact body, by name, with
        what to do; a geometry model without collision pairs; joints of a kind that is not known;
        names that nobody has.

        Parameters
        ----------
        model : pinocchio.Model
        geometry_model : pinocchio.GeometryModel
            With Coal's geometries.
        meshes, skip, within, obstacles
            As for ``from_mujoco``.

        Returns
        -------
        Robot
        """
        from standoff.robots.pinocchio import load

        return _made(load(model, geometry_model, meshes, skip), within, obstacles)

    @staticmethod
    def from_urdf(  # noqa: PLR0913 - all but two are keywords with defaults
        path: str | Path,
        srdf: str | Path | None = None,
        *,
        package_dirs: Sequence[str | Path] = (),
        free_base: bool = False,
        mimic: bool | None = None,
        meshes: Meshes = None,
        skip: Sequence[str] = (),
        within: float | None = None,
        obstacles: Mapping[str, Any] | None = None,
    ) -> Robot:
        """A robot of a URDF file, read by Pinocchio.

        Its pairs are all but those of parent and child and of links that are fixed to each other,
        less those that the SRDF disables.

        Raises ModuleNotFoundError: Pinocchio is not installed; the message names the extra. Raises
        FileNotFoundError: there is no such file. Raises ValueError as ``from_pinocchio``; files of
        meshes that are not there, no collision geometry at all, mimic joints without `mimic`, a
        joint in the SRDF that the robot does not have.

        Parameters
        ----------
        path, srdf : str or path
        package_dirs : list of str or path
            Where ``package://`` begins. The folders above the file are tried too.
        free_base : bool
            The base moves freely: q begins with a position and a quaternion (x, y, z, w).
        mimic : bool, optional
            Joints that mimic another follow it (True), or move by themselves (False). To be said
            where the file has any.
        meshes, skip, within, obstacles
            As for ``from_mujoco``.

        Returns
        -------
        Robot
        """
        from standoff.robots.urdf import UrdfOptions, load

        options = UrdfOptions(tuple(map(str, package_dirs)), free_base, mimic, meshes, tuple(skip))
        return _made(load(path, srdf, options), within, obstacles)

    def with_obstacles(self, obstacles: Mapping[str, Any]) -> Robot:
        """The same robot among more obstacles.

        Raises TypeError: no mapping of names to bodies. Raises ValueError: a name that a geometry
        has, no pose.

        Parameters
        ----------
        obstacles : mapping of str to (Body, Solid or Compound, pose), or to Body
            World poses; a body alone is where its own frame is the world's. Each is a pair with
            every geometry that moves.

        Returns
        -------
        Robot
        """
        read = read_obstacles(obstacles, self.geoms.names)
        within = None if self.within == math.inf else self.within
        return Robot(self.loaded, within=within, obstacles=self.obstacles | read)

    def clearance(self, q: Any) -> RobotAnswer:
        """The nearest pair at a configuration, from nothing.

        Raises ValueError: a wrong size, a number that is not finite; a robot without pairs.

        Parameters
        ----------
        q : (nq,) array
            Outside the limits too.

        Returns
        -------
        RobotAnswer
            Its ``clearance`` is proven for all pairs.
        """
        self._check_pairs()
        return self._nearest(self.kinematics.check(q))

    def distances(self, q: Any, within: float | None = None) -> RobotRows:
        """All pairs within a horizon at a configuration, with Jacobian rows, from nothing.

        Raises ValueError as ``clearance``, but a robot without pairs has no rows; a horizon that is
        not positive.

        Parameters
        ----------
        q : (nq,) array
        within : float, optional
            Length; the robot's own if not given. Of each horizon a world is kept: give few.

        Returns
        -------
        RobotRows
        """
        horizon = self.within if within is None else positive(within, "within", infinite=True)
        return self._rows(self.kinematics.check(q), self._horizons.world(horizon))

    def clearances(self, Q: Any, *, workers: int = 1) -> RobotAnswers:
        """The nearest pair at each of many configurations.

        Raises ValueError as ``clearance``; the number of the row is told.

        Parameters
        ----------
        Q : (m, nq) array
        workers : int
            Threads that share the configurations; the answers are the same for any number.

        Returns
        -------
        RobotAnswers
        """
        self._check_pairs()
        shape = shape_of(Q)
        if shape is not None and (len(shape) != 2 or shape[1] != self.nq):
            raise StandoffError(f"Q has the shape {shape}: give (m, {self.nq}).", "Q", Q)
        given = finite_rows(Q, "Q", self.nq)
        workers = whole_number(workers, "workers")
        configurations = [_checked_row(self.kinematics, k, q) for k, q in enumerate(given)]
        answers: list[Any] = [None] * len(given)

        def some(first: int, end: int) -> None:
            for k in range(first, end):
                answers[k] = self._nearest(configurations[k])

        in_parts(some, len(given), workers)
        return RobotAnswers(answers, self.nv)

    def start(self, q: Any) -> RobotState:
        """The state of a first configuration, for ``step``."""
        q = self.kinematics.check(q)
        motion = self.kinematics.motion(q)
        return RobotState(q, self.world.start(motion.poses), motion)

    def step(self, state: RobotState, q: Any) -> tuple[RobotState, RobotRows]:
        """All pairs within the horizon, from the state of a configuration nearby.

        Raises TypeError, ValueError as ``distances``; a state of another robot.

        Parameters
        ----------
        state : RobotState
            Of this robot; it is not changed.
        q : (nq,) array

        Returns
        -------
        (RobotState, RobotRows)
        """
        q = self.kinematics.check(q)
        motion = self.kinematics.motion(q)
        after, answer = self.world.step(state.world, motion.poses)
        rows = RobotRows(answer, q, motion, self._mounted, self.within)
        return RobotState(q, after, motion), rows

    def rows(self, state: RobotState) -> RobotRows:
        """The answer at the configuration of a state."""
        answer = self.world.answer(state.world)
        return RobotRows(answer, state.q, state.motion, self._mounted, self.within)

    def certify(self, path: Any, clearance: float = ASKED_CLEARANCE, **options: Any) -> PathProof:
        """Prove that a joint path keeps a clearance at every instant: see `certify.certify`."""
        from standoff.robots.certify import certify

        return certify(self, path, clearance, **options)

    def certify_box(
        self, lower: Any, upper: Any, clearance: float = ASKED_CLEARANCE, **options: Any
    ) -> BoxProof:
        """Prove that all configurations in a box keep a clearance: see `boxes.certify_box`."""
        from standoff.robots.boxes import certify_box

        return certify_box(self, lower, upper, clearance, **options)

    def view(self, what: Any, **options: Any) -> RobotPage:
        """Show the robot in the browser, at a configuration or along a path: see `view.view`."""
        from standoff.robots.view import view

        return view(self, what, **options)

    def _nearest(self, q: Array) -> RobotAnswer:
        rows = self.nearest_rows(q)
        return rows[int(np.argmin(rows.distance))]

    def _check_pairs(self) -> None:
        if not len(self._horizons.pairs):
            raise StandoffError(
                f"{self.loaded.source} watches no pair: add obstacles by with_obstacles, or see "
                "robot.report() for what was left out."
            )


def _made(loaded: Loaded, within: float | None, obstacles: Mapping[str, Any] | None) -> Robot:
    read = {} if obstacles is None else read_obstacles(obstacles, loaded.geoms.names)
    return Robot(loaded, within=within, obstacles=read)


def _checked_row(kinematics: Kinematics, k: int, q: Array) -> Array:
    try:
        return kinematics.check(q)
    except StandoffError as error:
        raise StandoffError(f"Row {k} of Q: {error}", "Q", q) from error
