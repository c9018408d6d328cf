"""The solids of a file with their names, colours and places."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from standoff.cad.opencascade import (
    KINDS,
    cast,
    caught_lines,
    compound,
    explored,
    is_kind,
    matrix_of,
)
from standoff.checks.units import METRES
from standoff.errors import CadError
from standoff.typing import Array

NAMES = {"millimetre": "mm", "centimetre": "cm", "metre": "m", "INCH": "inch", "inch": "inch"}
NO_NAME = re.compile(r"=>\[[\d:]*\]|Open CASCADE STEP translator [\d. ]+|SOLID|COMPOUND|NONE")
"""What OpenCASCADE writes for a name where nobody gave one."""
MOST_LINES = 3
"""Of OpenCASCADE, in a message."""
Colour = tuple[float, float, float, float]


@dataclass(frozen=True)
class Instance:
    """A shape at its place: a solid, or what is in no solid."""

    name: str
    shape: Any
    pose: Array
    colour: Colour | None


def at_place(instance: Instance) -> Any:
    """An instance's shape where it is."""
    from OCP.gp import gp_Trsf
    from OCP.TopLoc import TopLoc_Location

    motion = gp_Trsf()
    motion.SetValues(*np.asarray(instance.pose)[:3].ravel().tolist())
    return instance.shape.Moved(TopLoc_Location(motion))


def step_instances(file: Path, unit: str) -> tuple[list[Instance], str]:
    """The instances of a STEP file, and its unit.

    Raises CadError: a file that OpenCASCADE can't read.
    """
    from OCP.STEPCAFControl import STEPCAFControl_Reader

    reader = STEPCAFControl_Reader()
    reader.SetNameMode(True)
    reader.SetColorMode(True)
    document = _transferred(reader, file, unit)
    return list(_walked(document, file.stem)), _file_unit(reader.ChangeReader())


def iges_instances(file: Path, unit: str) -> tuple[list[Instance], str]:
    """The same of an IGES file; OpenCASCADE converts its unit."""
    from OCP.IGESCAFControl import IGESCAFControl_Reader

    reader = IGESCAFControl_Reader()
    reader.SetNameMode(True)
    reader.SetColorMode(True)
    document = _transferred(reader, file, unit)
    name = reader.IGESModel().GlobalSection().UnitName()
    told = name.ToCString().strip().lower() if name is not None else ""
    return list(_walked(document, file.stem)), {"in": "inch"}.get(told, told)


def brep_instances(file: Path) -> list[Instance]:
    """The instances of a file of OpenCASCADE's own, which has neither names nor units."""
    from OCP.BRep import BRep_Builder
    from OCP.BRepTools import BRepTools
    from OCP.TopoDS import TopoDS_Shape

    shape = TopoDS_Shape()
    if not BRepTools.Read_s(shape, str(file), BRep_Builder()) or shape.IsNull():
        raise CadError(f"{file}: OpenCASCADE can't read it; it may be cut off.")
    return shape_instances(shape, file.stem)


def shape_instances(shape: Any, name: str) -> list[Instance]:
    """The solids of a shape, numbered if there are several."""
    found = list(_solids(shape))
    names = [name] if len(found) == 1 else [f"{name} {k}" for k in range(1, len(found) + 1)]
    return [_placed(one, np.eye(4), label, None) for one, label in zip(found, names, strict=True)]


def _transferred(reader: Any, file: Path, unit: str) -> Any:
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDocStd import TDocStd_Document
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    with caught_lines() as lines:
        read = reader.ReadFile(str(file)) == IFSelect_RetDone
        document = TDocStd_Document(TCollection_ExtendedString("standoff"))
        XCAFDoc_DocumentTool.SetLengthUnit_s(document, METRES[unit])
        made = read and reader.Transfer(document)
    told = "".join(f" OpenCASCADE: {line}." for line in lines[:MOST_LINES])
    if not read:
        raise CadError(f"{file}: OpenCASCADE can't read it; it may be damaged.{told}")
    if not made:
        raise CadError(f"{file} has no shape that OpenCASCADE can make.{told}")
    return document


def _file_unit(reader: Any) -> str:
    from OCP.collections import Sequence_TCollection_AsciiString as Names

    lengths = Names()
    reader.FileUnits(lengths, Names(), Names())
    told = [lengths.Value(k).ToCString() for k in range(1, lengths.Length() + 1)]
    return " and ".join(sorted({NAMES.get(name, name) for name in told}))


def _walked(document: Any, unnamed: str) -> Iterator[Instance]:
    from OCP.collections import Sequence_TDF_Label
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    roots = Sequence_TDF_Label()
    tool.GetFreeShapes(roots)
    for k in range(1, roots.Length() + 1):
        yield from _below(roots.Value(k), np.eye(4), (), None, unnamed)


def _below(
    label: Any, pose: Array, names: tuple[str, ...], colour: Colour | None, unnamed: str
) -> Iterator[Instance]:
    """The instances below a label; `unnamed` is the name of those that neither they nor what they
    are in has one: of the nearest assembly, or of the file."""
    from OCP.collections import Sequence_TDF_Label
    from OCP.TDF import TDF_Label
    from OCP.XCAFDoc import XCAFDoc_ShapeTool

    colour, unnamed = _colour(label) or colour, _name(label) or unnamed
    if XCAFDoc_ShapeTool.IsAssembly_s(label):
        components = Sequence_TDF_Label()
        XCAFDoc_ShapeTool.GetComponents_s(label, components)
        for k in range(1, components.Length() + 1):
            component, target = components.Value(k), TDF_Label()
            XCAFDoc_ShapeTool.GetReferredShape_s(component, target)
            at = pose @ matrix_of(XCAFDoc_ShapeTool.GetLocation_s(component))
            name = _name(component) or _name(target)
            below = (*names, name) if name else names
            yield from _below(target, at, below, _colour(component) or colour, unnamed)
        return
    shape = XCAFDoc_ShapeTool.GetShape_s(label)
    name = "/".join(names) or unnamed
    found = list(_solids(shape))
    for k, solid in enumerate(found, 1):
        yield _placed(solid, pose, name if len(found) == 1 else f"{name} {k}", colour)


def _solids(shape: Any) -> Iterator[Any]:
    """The solids of a shape; then the shells that are in none, and all loose faces as one."""
    if is_kind(shape, "solid") or is_kind(shape, "shell") or is_kind(shape, "face"):
        yield shape
        return
    yield from explored(shape, "solid")
    yield from explored(shape, "shell", "solid")
    loose = list(explored(shape, "face", "shell"))
    if loose:
        yield compound(loose)


def _placed(shape: Any, pose: Array, name: str, colour: Colour | None) -> Instance:
    """A shape in its own frame, with its own place in the pose."""
    from OCP.TopLoc import TopLoc_Location

    own = matrix_of(shape.Location())
    return Instance(name, as_its_kind(shape.Located(TopLoc_Location())), pose @ own, colour)


def as_its_kind(shape: Any) -> Any:
    """A shape as the solid, shell or face that it is; a compound as it is."""
    kind = next((kind for kind in KINDS if is_kind(shape, kind)), None)
    return shape if kind is None else cast(kind, shape)


def _name(label: Any) -> str:
    from OCP.TDataStd import TDataStd_Name

    found = TDataStd_Name()
    if not label.FindAttribute(TDataStd_Name.GetID_s(), found):
        return ""
    name = str(found.Get().ToExtString()).strip()
    return "" if NO_NAME.fullmatch(name) else name


def _colour(label: Any) -> Colour | None:
    from OCP.Quantity import Quantity_ColorRGBA
    from OCP.XCAFDoc import XCAFDoc_ColorGen, XCAFDoc_ColorSurf, XCAFDoc_ColorTool

    found = Quantity_ColorRGBA()
    for kind in (XCAFDoc_ColorSurf, XCAFDoc_ColorGen):
        if XCAFDoc_ColorTool.GetColor_s(label, kind, found):
            rgb = found.GetRGB()
            return rgb.Red(), rgb.Green(), rgb.Blue(), float(found.Alpha())
    return None
