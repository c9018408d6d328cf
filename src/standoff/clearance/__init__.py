"""Reports on the clearance of a scene's bodies: verdicts, fits that are meant, tables, pictures."""

from typing import TYPE_CHECKING

from standoff.on_demand import on_demand

if TYPE_CHECKING:
    from standoff.clearance.checked_pairs import Scope, check
    from standoff.clearance.fits import Fit, load_fits
    from standoff.clearance.report import Report, Wanted
else:
    __getattr__, __dir__ = on_demand(__name__)

__all__ = ["Fit", "Report", "Scope", "Wanted", "check", "load_fits"]
