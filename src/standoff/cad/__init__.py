"""CAD parts: STEP, BREP and IGES files as boundaries and bodies (the extra `cad`)."""

from typing import TYPE_CHECKING

from standoff.on_demand import on_demand

if TYPE_CHECKING:
    from standoff.cad.assembly import Assembly, Part, PartReport
    from standoff.cad.reading import (
        common_volumes,
        from_shape,
        read_brep,
        read_cad,
        read_iges,
        read_step,
        reports_of,
    )
    from standoff.errors import CadError
else:
    __getattr__, __dir__ = on_demand(__name__)

__all__ = [
    "Assembly",
    "CadError",
    "Part",
    "PartReport",
    "common_volumes",
    "from_shape",
    "read_brep",
    "read_cad",
    "read_iges",
    "read_step",
    "reports_of",
]
