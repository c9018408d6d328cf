"""From ``shapes = "BODY"`` in ``[parameters.NAME]`` to a pair whose bodies change."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import product

from standoff.checks.names import one_of
from standoff.errors import StandoffError
from standoff.scene import Scene
from standoff.scene.files import toml_tables
from standoff.scene.reader import SceneTable, unknown_name
from standoff.sweep.parameters import Parameter
from standoff.sweep.subjects.pair import ConvexPair
from standoff.sweep.subjects.shaped_body import ShapedBody, shape_numbers
from standoff.sweep.subjects.subject import Subject
from standoff.tracking.inputs import check_pair


def shape_parameter(name: str, table: SceneTable, subject: Subject) -> Parameter:
    """Return the parameter of a table with ``shapes``, without its range.

    Raises SceneError: a subject that is no pair of convex bodies, another body, a body that is read
    from a file, or what its shape has no number of.
    """
    if not isinstance(subject, ConvexPair):
        raise table.error(
            f"changes the shape of a body, and this job is over {subject.name}: shapes change in "
            "jobs of a scene's pair of convex bodies",
            "shapes",
        )
    body = table.text("shapes", example=f'shapes = "{subject.movable[-1]}"')
    if body not in subject.movable:
        raise table.error(unknown_name(body, subject.movable, "body of the pair"), "shapes")
    own = body_table(subject.scene, body)
    if "body" in own:
        raise table.error(
            f"'{body}' is read from a file, and has no numbers that can change: give it by a "
            "'shape' in the scene",
            "shapes",
        )
    known, what = shape_numbers(own), table.text("what", example='what = "radius"')
    several = [one for one in known if "." in one and what.startswith(one.partition(".")[0])]
    if several and what not in known:
        raise table.error(f"'{what}' is none of its numbers: write {one_of(several)}", "what")
    table.choice("what", known, noun=f"number of {own.text('shape')} '{body}'")
    return Parameter(name, body, what, shape=True)


def body_table(scene: Scene, name: str) -> SceneTable:
    """Return the table ``[bodies.NAME]`` of a scene's file."""
    return SceneTable(toml_tables(scene.text), file=scene.file).table("bodies").table(name)


def with_shapes(
    top: SceneTable, subject: Subject, parameters: Sequence[Parameter], kind: str
) -> Subject:
    """Return the subject whose bodies are made for each row; the same one where no parameter
    changes a shape.

    Raises SceneError: ends of ranges that make no body, or none that goes with the other one.

    Parameters
    ----------
    top : SceneTable
        The job's.
    subject : Subject
    parameters : sequence of Parameter
    kind : str
        Of the sampler.
    """
    if not isinstance(subject, ConvexPair) or not any(p.shape for p in parameters):
        return subject
    a, b = (
        ShapedBody(name, body_table(subject.scene, name), parameters)
        if any(p.shape and p.moves == name for p in parameters)
        else None
        for name in subject.scene.pair
    )
    if kind != "file":
        for k, one in enumerate((a, b)):
            if one is not None:
                _check_ends(top, one, subject, k, parameters)
    return replace(subject, shaped=(a, b))


def _check_ends(
    top: SceneTable,
    shaped: ShapedBody,
    subject: ConvexPair,
    k: int,
    parameters: Sequence[Parameter],
) -> None:
    """Make a body of all combinations of its ranges' ends."""
    own = [p for p in parameters if p.shape and p.moves == shaped.name]
    for ends in product(*((("from", p.low), ("to", p.high)) for p in own)):
        pair = list(subject.bodies)
        try:
            pair[k] = shaped.made(tuple(x + 0.0 for _, x in ends))
            check_pair(pair[0], pair[1])
        except StandoffError as error:
            # which of several is to blame is not known
            place = f"parameters.{own[0].name}" + (f".{ends[0][0]}" if len(own) == 1 else "")
            raise top.error(str(error), place) from error
