"""Reading STEP, BREP and IGES files, and shapes of other libraries on OpenCASCADE."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from time import perf_counter
from typing import Any

from standoff.cad.assembly import Assembly, Part, PartReport
from standoff.cad.files import ENDINGS, check_lines, check_step, existing
from standoff.checks.real_numbers import shown
from standoff.checks.units import known_unit
from standoff.errors import CadError, StandoffError, StandoffTypeError
from standoff.wording import counted

MOST_NAMED = 5


def read_step(path: Any, *, unit: str = "mm", heal: bool = False, keep: str = "all") -> Assembly:
    """The parts of a STEP file, with names, colours and places.

    Parameters
    ----------
    path : str or Path
    unit : "mm", "cm", "m" or "inch"
        Of the lengths that are returned; the file's are converted, which the report tells.
    heal : bool
        Let OpenCASCADE repair shapes that are refused as they are; ``report.healed`` tells what it
        changed.
    keep : "all" or "readable"
        With "all", a part that is refused is an error, and nothing is returned; with "readable" it
        is left out and told in ``refusals``.

    Returns
    -------
    Assembly
        Of each part the shape is a `Body` where it is proven convex, else a `Boundary`.

    Raises
    ------
    CadError
        A file that is empty, cut off, damaged, or has more than ``MOST_ENTITIES`` entities; a part
        that is refused: an open shell, faces without area, that cross themselves or each other, or
        have no exact form.
    FileNotFoundError
    ModuleNotFoundError
        If OpenCASCADE is not installed; the message names the extra.
    StandoffError, TypeError
        An unknown unit or option; not a path.
    """
    start = perf_counter()
    file = existing(path)
    checked = _checked(unit, heal, keep)
    check_step(file)
    from standoff.cad.instances import step_instances

    instances, file_unit = step_instances(file, unit)
    return _assembly(file.name, instances, checked, file_unit, start)


def read_iges(path: Any, *, unit: str = "mm", heal: bool = False, keep: str = "all") -> Assembly:
    """The solids of an IGES file; its loose faces are sewn only with ``heal=True``.

    Parameters
    ----------
    path, unit, heal, keep : as for `read_step`.

    Returns
    -------
    Assembly

    Raises
    ------
    CadError, FileNotFoundError, ModuleNotFoundError, StandoffError, TypeError
        As for `read_step`.
    """
    start = perf_counter()
    file = existing(path)
    checked = _checked(unit, heal, keep)
    check_lines(file, "IGES", None)
    from standoff.cad.instances import iges_instances

    instances, file_unit = iges_instances(file, unit)
    return _assembly(file.name, instances, checked, file_unit, start)


def read_brep(path: Any, *, heal: bool = False, keep: str = "all") -> Assembly:
    """The solids of a BREP file, OpenCASCADE's own, whose lengths have no unit.

    Parameters
    ----------
    path, heal, keep : as for `read_step`.

    Returns
    -------
    Assembly
        Its unit is empty: lengths are as in the file.

    Raises
    ------
    CadError, FileNotFoundError, ModuleNotFoundError, StandoffError, TypeError
        As for `read_step`.
    """
    start = perf_counter()
    file = existing(path)
    checked = _checked("", heal, keep)
    check_lines(file, "BREP", b"CASCADE Topology")
    from standoff.cad.instances import brep_instances

    return _assembly(file.name, brep_instances(file), checked, "", start)


def read_cad(path: Any, *, unit: str = "mm", heal: bool = False, keep: str = "all") -> Assembly:
    """A file of any of these kinds, by its ending.

    Parameters
    ----------
    path, unit, heal, keep : as for `read_step`; a BREP file's lengths stay as they are.

    Returns
    -------
    Assembly

    Raises
    ------
    CadError, FileNotFoundError, ModuleNotFoundError, StandoffError, TypeError
        As for `read_step`, and for another ending.
    """
    file = existing(path)
    kind = ENDINGS.get(file.suffix.lower())
    if kind == "brep":
        return read_brep(file, heal=heal, keep=keep)
    if kind is None:
        raise CadError(f"{file}: give a file that ends in {', '.join(ENDINGS)}.", "path", path)
    return (read_step if kind == "step" else read_iges)(file, unit=unit, heal=heal, keep=keep)


def from_shape(
    shape: Any, *, name: str = "part", heal: bool = False, keep: str = "all"
) -> Assembly:
    """The solids of a shape of OpenCASCADE, or of an object that wraps one.

    Parameters
    ----------
    shape : TopoDS_Shape, or an object of build123d or CadQuery
        Its attribute ``wrapped`` is taken; of a CadQuery workplane, ``val()``.
    name : str
    heal, keep : as for `read_step`.

    Returns
    -------
    Assembly
        Lengths are as in the shape; those libraries think in millimetres.

    Raises
    ------
    CadError, ModuleNotFoundError, StandoffError, TypeError
        As for `read_step`; not such an object.
    """
    start = perf_counter()
    checked = _checked("", heal, keep)
    from standoff.cad.instances import shape_instances

    given = shape.val() if hasattr(shape, "val") and not hasattr(shape, "wrapped") else shape
    given = getattr(given, "wrapped", given)
    if not hasattr(given, "ShapeType"):
        raise StandoffTypeError(
            f"shape = {shown(shape)}: give a TopoDS_Shape, or an object with one as .wrapped.",
            "shape",
            shape,
        )
    return _assembly(name, shape_instances(given, name), checked, "", start)


def _checked(unit: str, heal: bool, keep: str) -> tuple[str, bool, str]:
    if unit:
        known_unit(unit)
    if not isinstance(heal, bool):
        raise StandoffTypeError(f"heal = {shown(heal)}: give True or False.", "heal", heal)
    if keep not in ("all", "readable"):
        raise StandoffError(f"keep = {shown(keep)}: give 'all' or 'readable'.", "keep", keep)
    return unit, heal, keep


def _assembly(
    source: str,
    instances: Sequence[Any],
    options: tuple[str, bool, str],
    file_unit: str,
    start: float,
) -> Assembly:
    """Make each solid once; raise if one is refused, unless only the readable ones are wanted."""
    from standoff.cad.making import Made, made_part

    unit, heal, keep = options
    if not instances:
        raise CadError(f"{source} has no solid.")
    kept: list[tuple[Any, Made]] = []
    parts, refusals, empty = [], [], []
    for instance in instances:
        made = next((m for shape, m in kept if shape.IsPartner(instance.shape)), None)
        if made is None:
            made = made_part(instance.shape, instance.name, heal)
            kept.append((instance.shape, made))
        if not made.report.faces:
            empty.append(f"{instance.name}: left out, it has no face")
            continue
        if made.shape is None:
            refusals.append(f"{instance.name}: {made.report.refused}")
            continue
        placed = instance.name, made.shape, instance.pose, instance.colour
        parts.append(Part(*placed, made.report, made.solid))
    if not parts and not refusals:
        raise CadError(f"{source} has no solid with faces.")
    if refusals and (keep == "all" or not parts):
        more = f"; and {len(refusals) - MOST_NAMED} more" if len(refusals) > MOST_NAMED else ""
        raise CadError(
            f"{source}: {len(refusals)} of {counted(len(instances), 'part')} refused. "
            + "; ".join(refusals[:MOST_NAMED])
            + more,
            refusals=tuple(refusals),
        )
    spent = perf_counter() - start
    return Assembly(tuple(parts), unit, file_unit, source, (*refusals, *empty), spent)


def reports_of(path: Any, *, heal: bool = False) -> tuple[PartReport, ...]:
    """What is found about every different solid of a file, refused ones included.

    Parameters
    ----------
    path : str or Path
    heal : bool

    Returns
    -------
    tuple of PartReport

    Raises
    ------
    CadError, FileNotFoundError, ModuleNotFoundError, TypeError
        As for `read_step`, but for parts that are refused.
    """
    file: Path = existing(path)
    from standoff.cad.instances import brep_instances, iges_instances, step_instances
    from standoff.cad.making import made_part

    kind = ENDINGS.get(file.suffix.lower())
    if kind == "step":
        check_step(file)
        instances = step_instances(file, "mm")[0]
    elif kind == "iges":
        instances = iges_instances(file, "mm")[0]
    else:
        instances = brep_instances(file)
    seen: list[Any] = []
    found = []
    for instance in instances:
        if not any(instance.shape.IsPartner(one) for one in seen):
            seen.append(instance.shape)
            found.append(made_part(instance.shape, instance.name, heal).report)
    return tuple(found)
