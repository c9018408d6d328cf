"""Control theory of the law: gains, growth factors, stability, basins, Lyapunov levels."""

from standoff.control.basin import Basin, basin
from standoff.control.curvature import LeastCurvature, least_curvature, principal_curvatures
from standoff.control.gain import least_eigenvalue, min_gain, reach, witness_speeds
from standoff.control.growth import (
    euler_min_gain,
    growth_polynomial,
    sampled_roots,
    stability_limit,
    steady_error,
)
from standoff.control.lyapunov import LyapunovLevels, lyapunov_level
from standoff.control.steps import StepGrowth, step_growth
from standoff.tracking.feedback import growth_factor

__all__ = [
    "Basin",
    "LeastCurvature",
    "LyapunovLevels",
    "StepGrowth",
    "basin",
    "euler_min_gain",
    "growth_factor",
    "growth_polynomial",
    "least_curvature",
    "least_eigenvalue",
    "lyapunov_level",
    "min_gain",
    "principal_curvatures",
    "reach",
    "sampled_roots",
    "stability_limit",
    "steady_error",
    "step_growth",
    "witness_speeds",
]
