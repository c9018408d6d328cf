"""Sweeps: distances at very many poses, of a pair, a world or a robot, as totals and worst rows."""

from typing import TYPE_CHECKING

from standoff.on_demand import on_demand

if TYPE_CHECKING:
    from standoff.sweep.estimate import Estimate, estimated
    from standoff.sweep.folder import FolderError
    from standoff.sweep.job import Job
    from standoff.sweep.keep import Bins, Keep
    from standoff.sweep.proof.effort import Effort
    from standoff.sweep.proof.proof import Proof
    from standoff.sweep.proof.report import ProofReport
    from standoff.sweep.proof.summary import Kind, Places, ProofSummary
    from standoff.sweep.reading import load_job
    from standoff.sweep.report import Report
    from standoff.sweep.rows import Rows
    from standoff.sweep.run import run_proof, run_sweep
    from standoff.sweep.summary import Summary
else:
    __getattr__, __dir__ = on_demand(__name__)

__all__ = [
    "Bins",
    "Effort",
    "Estimate",
    "FolderError",
    "Job",
    "Keep",
    "Kind",
    "Places",
    "Proof",
    "ProofReport",
    "ProofSummary",
    "Report",
    "Rows",
    "Summary",
    "estimated",
    "load_job",
    "run_proof",
    "run_sweep",
]
