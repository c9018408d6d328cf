"""The few calls of OpenCASCADE's bindings whose names or types need care."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np

from standoff.errors import of_extra

with of_extra("OpenCASCADE", "cad"):
    import OCP  # noqa: F401

from OCP.TopAbs import (
    TopAbs_EDGE,
    TopAbs_FACE,
    TopAbs_FORWARD,
    TopAbs_SHELL,
    TopAbs_SOLID,
    TopAbs_VERTEX,
    TopAbs_WIRE,
)
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS

from standoff.typing import Array

KINDS = {
    "solid": TopAbs_SOLID,
    "shell": TopAbs_SHELL,
    "face": TopAbs_FACE,
    "wire": TopAbs_WIRE,
    "edge": TopAbs_EDGE,
    "vertex": TopAbs_VERTEX,
}


def cast(kind: str, shape: Any) -> Any:
    """A shape as the one it is; version 8 of the bindings dropped the names' endings."""
    name = kind.capitalize()
    return (getattr(TopoDS, name, None) or getattr(TopoDS, f"{name}_s"))(shape)


def explored(shape: Any, kind: str, outside: str | None = None) -> Iterator[Any]:
    """The parts of a kind in a shape, in its order; with `outside`, those in no part of that."""
    found = TopExp_Explorer()
    if outside is None:
        found.Init(shape, KINDS[kind])
    else:
        found.Init(shape, KINDS[kind], KINDS[outside])
    while found.More():
        yield cast(kind, found.Current())
        found.Next()


def forward(shape: Any) -> bool:
    """Has it the orientation of its geometry?"""
    return bool(shape.Orientation() == TopAbs_FORWARD)


def is_kind(shape: Any, kind: str) -> bool:
    return bool(shape.ShapeType() == KINDS[kind])


def compound(shapes: Sequence[Any]) -> Any:
    """Several shapes as one."""
    from OCP.BRep import BRep_Builder
    from OCP.TopoDS import TopoDS_Compound

    made, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(made)
    for shape in shapes:
        builder.Add(made, shape)
    return made


def coordinates(p: Any) -> Array:
    """A point, vector or direction as (3,) or (2,)."""
    if hasattr(p, "Z"):
        return np.array([p.X(), p.Y(), p.Z()])
    return np.array([p.X(), p.Y()])


def box_of(shape: Any) -> tuple[Array, Array]:
    """(low, high) of a box around a shape; of nothing, at the origin."""
    from OCP.Bnd import Bnd_Box
    from OCP.BRepBndLib import BRepBndLib

    box = Bnd_Box()
    BRepBndLib.Add_s(shape, box, False)
    if box.IsVoid():
        return np.zeros(3), np.zeros(3)
    return coordinates(box.CornerMin()), coordinates(box.CornerMax())


@contextmanager
def caught_lines() -> Iterator[list[str]]:
    """Lines that OpenCASCADE would print on the terminal, once it is done."""
    from OCP.Message import Message, Message_Gravity, Message_PrinterToReport, Message_Report

    messenger, report = Message.DefaultMessenger_s(), Message_Report()
    printers, printer = list(messenger.Printers()), Message_PrinterToReport()
    lines: list[str] = []
    printer.SetReport(report)
    for one in printers:
        messenger.RemovePrinter(one)
    messenger.AddPrinter(printer)
    try:
        yield lines
    finally:
        messenger.RemovePrinter(printer)
        for one in printers:
            messenger.AddPrinter(one)
        for gravity in ("Fail", "Alarm", "Warning", "Info"):
            alerts = report.GetAlerts(getattr(Message_Gravity, f"Message_{gravity}"))
            lines += [str(alert.GetMessageKey()).strip("* ") for alert in alerts]


def frame_of(at: Any) -> tuple[Array, Array]:
    """(axes as columns, origin) of a gp_Ax3 or gp_Ax2."""
    axes = [coordinates(d) for d in (at.XDirection(), at.YDirection(), at.Direction())]
    return np.column_stack(axes), coordinates(at.Location())


def matrix_of(location: Any) -> Array:
    """A TopLoc_Location as (4, 4)."""
    transformation = location.Transformation()
    rows = [[transformation.Value(i, j) for j in (1, 2, 3, 4)] for i in (1, 2, 3)]
    return np.array([*rows, [0.0, 0.0, 0.0, 1.0]])
