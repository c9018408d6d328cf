"""Signed distances in CasADi, with exact derivatives (docs/differentiable.md, docs/design.md)."""

from __future__ import annotations

from typing import Any

import numpy as np

from standoff.bodies.body import Body
from standoff.design import Design
from standoff.errors import StandoffError, of_extra
from standoff.frameworks import ambient, designed

with of_extra("CasADi", "casadi"):
    import casadi

__all__ = ["design_distance", "distance"]

_KEPT: list[Any] = []
"""CasADi does not own its callbacks: one that Python has freed fails when it is called."""

POSE = casadi.Sparsity.dense(4, 4)


def distance(a: Body, b: Body, *, undefined: str = "nan", name: str = "distance") -> Any:
    """A CasADi function: the signed minimum distance of two bodies at two poses.

    Make it once for a pair of bodies: it is kept until the program ends. Call it with MX
    expressions, not SX. For n poses use its ``map(n)``.

    Raises TypeError: no bodies. Raises ValueError: an unknown choice, or a name that CasADi does
    not take. When called, within CasADi's own RuntimeError: a matrix that is not a pose; undefined
    derivatives, if asked; a third derivative.

    Parameters
    ----------
    a, b : Body
    undefined : "nan" or "raise"
        Where a derivative, or a part of it, is not defined: nan with a `DerivativeWarning`, or an
        error.
    name : str
        Of the function, as CasADi takes it.

    Returns
    -------
    casadi.Callback
        (pose_a, pose_b), of 4 x 4, to the distance. Its Jacobian and Hessian by the matrices are
        those of the distance at the nearest pose.
    """
    check_name(name)
    return _CasadiValue(ambient.AmbientPair.of(a, b, undefined), name)


def design_distance(
    design_a: Design | Body,
    design_b: Design | Body,
    *,
    undefined: str = "nan",
    name: str = "design_distance",
) -> Any:
    """A CasADi function: the signed minimum distance of two designed bodies by their parameters
    and poses (docs/design.md).

    Make it once for a pair of designs, as `distance`. It has first derivatives, no second ones:
    Ipopt takes it with ``hessian_approximation="limited-memory"``.

    Raises TypeError: no designs. Raises ValueError: an unknown choice, or a name that CasADi does
    not take. When called, within CasADi's own RuntimeError: parameters that make no body; a matrix
    that is not a pose; undefined derivatives, if asked; a second derivative.

    Parameters
    ----------
    design_a, design_b : Design or Body
        A body does not change. All parameters are inputs: ``design.only("radius")`` has one.
    undefined : "nan" or "raise"
        As in `distance`. In flat and line contact derivatives by parameters are not defined.
    name : str
        Of the function, as CasADi takes it.

    Returns
    -------
    casadi.Callback
        Its inputs are named: ``a_radius`` is A's parameter ``radius``, ``b_radius`` B's; ``pose_a``
        and ``pose_b`` come last. A parameter of one index is a column, one of more than two a
        column of its numbers in NumPy's order.
    """
    check_name(name)
    pair = design_a, design_b
    params = [x.parameters if isinstance(x, Design) else {} for x in pair]
    return _CasadiDesignValue(designed.Designs.of(*pair, (params[0], params[1]), undefined), name)


def check_name(name: str) -> None:
    """Refuse a name that CasADi does not take.

    Raises StandoffError.
    """
    if not casadi.Function.check_name(name):
        raise StandoffError(
            f"name = {name!r}: give a letter, then letters, digits and single underscores.",
            "name",
            name,
        )


class NamedCallback(casadi.Callback):
    """A callback with named inputs and outputs of given sizes."""

    def __init__(
        self,
        pair: Any,
        name: str,
        inputs: dict[str, Any],
        outputs: dict[str, Any],
        options: Any = None,
    ) -> None:
        casadi.Callback.__init__(self)
        self.pair, self.inputs, self.outputs = pair, inputs, outputs
        self.construct(name, options or {})
        _KEPT.append(self)

    def get_n_in(self) -> int:
        return len(self.inputs)

    def get_n_out(self) -> int:
        return len(self.outputs)

    def get_name_in(self, k: int) -> str:
        return list(self.inputs)[k]

    def get_name_out(self, k: int) -> str:
        return list(self.outputs)[k]

    def get_sparsity_in(self, k: int) -> Any:
        return list(self.inputs.values())[k]

    def get_sparsity_out(self, k: int) -> Any:
        return list(self.outputs.values())[k]

    def has_jacobian(self) -> bool:
        return True

    def jacobian_outputs(self, names: list[str]) -> dict[str, Any]:
        """Sizes of the Jacobian's blocks, each output by each input."""
        sizes = [
            casadi.Sparsity.dense(rows.numel(), columns.numel())
            for rows in self.outputs.values()
            for columns in self.inputs.values()
        ]
        return dict(zip(names, sizes, strict=True))


class _CasadiValue(NamedCallback):
    """(pose_a, pose_b) to the distance."""

    def __init__(self, pair: ambient.AmbientPair, name: str) -> None:
        poses = {"pose_a": POSE, "pose_b": POSE}
        super().__init__(pair, name, poses, {"distance": casadi.Sparsity.dense(1, 1)})

    def eval(self, given: Any) -> Any:
        return [float(ambient.value(self.pair, *_poses(given)))]

    def get_jacobian(self, name: str, inputs: Any, outputs: Any, options: Any) -> Any:
        sizes = dict(zip(inputs, [POSE, POSE, casadi.Sparsity(1, 1)], strict=True))
        return _CasadiGradient(self.pair, name, sizes, self.jacobian_outputs(outputs), options)


class _CasadiGradient(NamedCallback):
    """(pose_a, pose_b, distance) to the rows of 16 derivatives by each pose."""

    def eval(self, given: Any) -> Any:
        gradient = ambient.first(self.pair, *_poses(given)).gradient
        return [_by_columns(gradient[body])[None] for body in range(2)]

    def get_jacobian(self, name: str, inputs: Any, outputs: Any, options: Any) -> Any:
        empty = [casadi.Sparsity(x.shape) for x in self.outputs.values()]
        sizes = dict(zip(inputs, [*self.inputs.values(), *empty], strict=True))
        blocks = self.jacobian_outputs(outputs)
        # Nothing depends on the value that comes in with the poses.
        for which in list(blocks)[2::3]:
            blocks[which] = casadi.Sparsity(blocks[which].shape)
        return _CasadiHessian(self.pair, name, sizes, blocks, options)


class _CasadiHessian(NamedCallback):
    """The same and the rows to the blocks of 16 x 16, each row by each input."""

    def eval(self, given: Any) -> Any:
        hessian = ambient.second(self.pair, *_poses(given)).hessian
        found: list[Any] = []
        for row in range(2):
            for column in range(2):
                block = hessian[row, :, :, column].transpose(1, 0, 3, 2)
                found.append(block.reshape(ambient.ENTRIES, ambient.ENTRIES))
            found.append(casadi.DM(ambient.ENTRIES, self.inputs_of_value()))
        return found

    def inputs_of_value(self) -> int:
        """Columns of the empty block: one, the distance."""
        return int(list(self.inputs.values())[2].numel())

    def get_jacobian(self, name: str, inputs: Any, outputs: Any, options: Any) -> Any:
        raise StandoffError(ambient.NO_THIRD)


def _poses(given: Any) -> list[Any]:
    return [np.asarray(x.full()) for x in given[:2]]


def _by_columns(matrix: Any) -> Any:
    """(16,) the entries in CasADi's order."""
    return matrix.T.reshape(ambient.ENTRIES)


class _CasadiDesignValue(NamedCallback):
    """(A's parameters, B's, pose_a, pose_b) to the distance."""

    def __init__(self, designs: designed.Designs, name: str) -> None:
        sides = zip("ab", designs.names, strict=True)
        labels = [f"{side}_{key}" for side, names in sides for key in names]
        for label in labels:
            check_name(label)
        sizes = [_size(shape) for shape in designs.shapes]
        inputs = dict(zip([*labels, "pose_a", "pose_b"], sizes, strict=True))
        super().__init__(designs, name, inputs, {"distance": casadi.Sparsity.dense(1, 1)})

    def eval(self, given: Any) -> Any:
        return [float(designed.value(self.pair, *_arrays(given, self.pair.shapes)))]

    def get_jacobian(self, name: str, inputs: Any, outputs: Any, options: Any) -> Any:
        sizes = [*self.inputs.values(), casadi.Sparsity(1, 1)]
        told = dict(zip(inputs, sizes, strict=True))
        return _DesignGradient(self.pair, name, told, self.jacobian_outputs(outputs), options)


class _DesignGradient(NamedCallback):
    """The same and the distance to a row of derivatives by each input."""

    def eval(self, given: Any) -> Any:
        shapes = self.pair.shapes
        found = designed.first(self.pair, *_arrays(given[:-1], shapes))
        return [_row_of(x) for x in found.gradients]

    def get_jacobian(self, name: str, inputs: Any, outputs: Any, options: Any) -> Any:
        raise StandoffError(designed.NO_SECOND)


def _size(shape: tuple[int, ...]) -> Any:
    if len(shape) == 2:
        return casadi.Sparsity.dense(*shape)
    return casadi.Sparsity.dense(int(np.prod(shape)), 1)


def _arrays(given: Any, shapes: Any) -> list[Any]:
    """Of CasADi's matrices, in NumPy's order and shapes."""
    return [np.asarray(x.full()).reshape(shape) for x, shape in zip(given, shapes, strict=True)]


def _row_of(gradient: Any) -> Any:
    """(1, entries) in CasADi's order."""
    return (gradient.T if gradient.ndim == 2 else gradient).reshape(1, -1)
