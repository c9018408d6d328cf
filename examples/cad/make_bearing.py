"""Write bearing.step: a shaft with a collar in a bored housing, and a seal ring between the two.

Run: python examples/cad/make_bearing.py [FILE]. Needs the extra `cad`. Lengths are in millimetres.
The seal sits askew: a torus of radii R and r at height h over the collar's face, its axis off by an
angle t, is h - R sin t - r away from it.
"""

import math
import re
import sys
from pathlib import Path

from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder, BRepPrimAPI_MakeTorus
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt, gp_Trsf
from OCP.Message import Message, Message_Gravity
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDocStd import TDocStd_Document
from OCP.TopLoc import TopLoc_Location
from OCP.XCAFDoc import XCAFDoc_DocumentTool

SHAFT, COLLAR, BORE = 10.0, 15.0, 10.45
OFF_CENTRE = (0.06, 0.08)  # of the shaft in the bore, along y and z
SPACE = 3.0  # between the collar's face (x = 0) and the housing's
SEAL, TUBE, SEAL_HEIGHT, TILT = 12.4, 0.9, 1.43, math.asin(0.02)


def along_x(start, radius, length, centre=(0.0, 0.0)):
    axis = gp_Ax2(gp_Pnt(start, *centre), gp_Dir(1.0, 0.0, 0.0))
    return BRepPrimAPI_MakeCylinder(axis, radius, length).Shape()


def parts():
    """(name, shape) of each."""
    rod, collar = (along_x(*c, OFF_CENTRE) for c in ((-20, SHAFT, 60), (-5, COLLAR, 5)))
    yield "shaft", BRepAlgoAPI_Fuse(rod, collar).Shape()
    block = BRepPrimAPI_MakeBox(gp_Pnt(SPACE, -20.0, -16.0), 25.0, 40.0, 32.0).Shape()
    yield "housing", BRepAlgoAPI_Cut(block, along_x(0.0, BORE, 40.0)).Shape()
    lean = gp_Dir(math.cos(TILT), 0.6 * math.sin(TILT), 0.8 * math.sin(TILT))
    axis = gp_Ax2(gp_Pnt(SEAL_HEIGHT, 0.0, 0.0), lean)
    yield "seal", BRepPrimAPI_MakeTorus(axis, SEAL, TUBE).Shape()


def main():
    target = sys.argv[1] if len(sys.argv) > 1 else str(Path(__file__).parent / "bearing.step")
    for printer in Message.DefaultMessenger_s().Printers():
        printer.SetTraceLevel(Message_Gravity.Message_Fail)
    document = TDocStd_Document(TCollection_ExtendedString("bearing"))
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    root = shapes.NewShape()
    TDataStd_Name.Set_s(root, TCollection_ExtendedString("bearing"))
    for name, shape in parts():
        part = shapes.AddShape(shape, False)
        use = shapes.AddComponent(root, part, TopLoc_Location(gp_Trsf()))
        for label in (part, use):
            TDataStd_Name.Set_s(label, TCollection_ExtendedString(name))
    shapes.UpdateAssemblies()
    writer = STEPCAFControl_Writer()
    writer.SetNameMode(True)
    writer.Transfer(document)
    writer.Write(target)
    written = Path(target).read_text("utf-8")
    undated = re.sub(r"'\d{4}-\d\d-\d\dT[\d:]+'", "'2026-11-29T12:00:00'", written)
    Path(target).write_text(undated, "utf-8")  # the same file each time


if __name__ == "__main__":
    main()
