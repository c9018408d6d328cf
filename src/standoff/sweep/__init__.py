"""Sweeps: distances at very many poses, of a pair, a world or a robot, as totals and worst rows."""

from typing import TYPE_CHECKING

from standoff.on_demand import on_demand

if TYPE_CHECKING:
    from standoff.sweep.estimate import Estimate, estimated
    from standoff.sweep.folder import FolderError
    from standoff.sweep.job import Bins, Job, Keep
    from standoff.sweep.reading import load_job
    from standoff.sweep.report import Report
    from standoff.sweep.rows import Rows
    from standoff.sweep.run import run_sweep
    from standoff.sweep.summary import Summary
else:
    __getattr__, __dir__ = on_demand(
        __name__,
        {
            "standoff.sweep.estimate": ("Estimate", "estimated"),
            "standoff.sweep.folder": ("FolderError",),
            "standoff.sweep.job": ("Bins", "Job", "Keep"),
            "standoff.sweep.reading": ("load_job",),
            "standoff.sweep.report": ("Report",),
            "standoff.sweep.run": ("run_sweep",),
            "standoff.sweep.rows": ("Rows",),
            "standoff.sweep.summary": ("Summary",),
        },
    )

__all__ = [
    "Bins",
    "Estimate",
    "FolderError",
    "Job",
    "Keep",
    "Report",
    "Rows",
    "Summary",
    "estimated",
    "load_job",
    "run_sweep",
]
