"""The smooth frames that are compiled for kinds of surfaces, which `frames.frame` tries first.

Those of this file are compiled ahead; `made_for` writes others in the same words.
"""

from functools import lru_cache
from typing import Any

from standoff.kernels.body import layout as L
from standoff.kernels.body.features import dimension
from standoff.kernels.compiler.decorators import entry, kernel, small
from standoff.kernels.compiler.entry import INT, REAL
from standoff.kernels.frame.inputs import refused
from standoff.kernels.frame.record import called_in_block, read_call
from standoff.kernels.frame.smooth import (
    EDGE_AND_FACE,
    FACE_AND_EDGE,
    FACES,
    seen_as,
    seen_as_nurbs,
    seen_as_sphere,
    seen_on_line,
    smooth_frame,
)
from standoff.kernels.state.arrays import (
    BLOCK_TIME_STEP,
    FINE,
)
from standoff.kernels.state.state import read_place


@small
def on_plane(ints, reals, chart, u, v):
    return seen_as(L.PLANE, ints, reals, chart, u, v)


@small
def on_sphere(ints, reals, chart, u, v):
    return seen_as_sphere(ints, reals, chart, u, v)


@small
def on_nurbs_2(ints, reals, chart, u, v):
    return seen_as_nurbs(2, ints, reals, chart, u, v)


@small
def on_nurbs_3(ints, reals, chart, u, v):
    return seen_as_nurbs(3, ints, reals, chart, u, v)


@small
def on_nurbs_4(ints, reals, chart, u, v):
    return seen_as_nurbs(4, ints, reals, chart, u, v)


@small
def on_nurbs_5(ints, reals, chart, u, v):
    return seen_as_nurbs(5, ints, reals, chart, u, v)


@kernel
def called_on(dims, look_a, look_b, record, h):
    """`smooth_frame` of a record of addresses."""
    return smooth_frame(look_a, look_b, dims, read_call(record), h)


@kernel
def called(look_a, look_b, record, h):
    """`called_on` faces."""
    return called_on(FACES, look_a, look_b, record, h)


@kernel
def called_of_planes_and(look_b, record, h):
    """`called_on` a polytope A's faces or its edges."""
    call = read_call(record)
    if on_edge(call.pair.ints_a, read_place(call.state).feature_a):
        return called_on(EDGE_AND_FACE, seen_on_line, look_b, record, h)
    return called_on(FACES, on_plane, look_b, record, h)


@kernel
def called_of_and_planes(look_a, record, h):
    """`called_on` a polytope B's faces or its edges."""
    call = read_call(record)
    if on_edge(call.pair.ints_b, read_place(call.state).feature_b):
        return called_on(FACE_AND_EDGE, look_a, seen_on_line, record, h)
    return called_on(FACES, look_a, on_plane, record, h)


@small
def on_edge(ints, feature):
    return dimension(ints, feature) == 1


@kernel
def smooth_in_block(look_a, look_b, pair, options, block):
    """`smooth_frame` of faces on a block (``blocks``), in place: 1, or 0 with nothing changed.

    What a thread of a GPU does (`standoff.gpu`).
    """
    call = called_in_block(pair, options, block)
    if refused(pair, call.inputs) != FINE:
        return 0
    return smooth_frame(look_a, look_b, FACES, call, block[BLOCK_TIME_STEP])


@entry(INT, REAL, work="smooth")
def sphere_sphere(record, h):
    """Ellipsoids, lenses and all that is made of their patches."""
    return called(on_sphere, on_sphere, record, h)


@entry(INT, REAL, work="smooth")
def plane_sphere(record, h):
    """A polytope and one of these."""
    return called_of_planes_and(on_sphere, record, h)


@entry(INT, REAL, work="smooth")
def sphere_plane(record, h):
    return called_of_and_planes(on_sphere, record, h)


@entry(INT, REAL, work="smooth")
def nurbs_2(record, h):
    """Two NURBS solids of degree 2."""
    return called(on_nurbs_2, on_nurbs_2, record, h)


@entry(INT, REAL, work="smooth")
def nurbs_3(record, h):
    """Two NURBS solids of degree 3."""
    return called(on_nurbs_3, on_nurbs_3, record, h)


@entry(INT, REAL, work="smooth")
def nurbs_4(record, h):
    """Two NURBS solids of degree 4."""
    return called(on_nurbs_4, on_nurbs_4, record, h)


@entry(INT, REAL, work="smooth")
def nurbs_5(record, h):
    """Two NURBS solids of degree 5."""
    return called(on_nurbs_5, on_nurbs_5, record, h)


ONE_KIND = """
def {name}(ints, reals, chart, u, v):
    return {seen}({constant}, ints, reals, chart, u, v)
"""
FRAME = """
def {name}(record, h):
    return {how}, record, h)
"""


def _look_at(kind: int, degree: int) -> tuple[str, Any]:
    """A function as `on_sphere`, and its name; the degree is that of a NURBS."""
    nurbs = kind == L.NURBS
    name = f"on_kind_{kind}_{degree}"
    seen, constant = ("seen_as_nurbs", degree) if nurbs else ("seen_as", kind)
    return name, _written(ONE_KIND.format(name=name, seen=seen, constant=constant), name, globals())


def _written(source: str, name: str, known: dict[str, Any]) -> Any:
    space = dict(known)
    exec(source, space)
    return space[name]


@lru_cache(maxsize=64)
def made_for(kind_a: int, degree_a: int, kind_b: int, degree_b: int) -> Any:
    """The entry for two kinds that are not compiled ahead: `sphere_sphere` with other constants."""
    looks = dict([_look_at(kind_a, degree_a), _look_at(kind_b, degree_b)])
    known = globals() | {name: small(each) for name, each in looks.items()}
    (a, _), (b, _) = _look_at(kind_a, degree_a), _look_at(kind_b, degree_b)
    name = f"smooth_{a}_{b}"
    how = f"called({a}, {b}"
    if (kind_a == L.PLANE) != (kind_b == L.PLANE):
        how = f"called_of_planes_and({b}" if kind_a == L.PLANE else f"called_of_and_planes({a}"
    return entry(INT, REAL, work="smooth")(_written(FRAME.format(name=name, how=how), name, known))
