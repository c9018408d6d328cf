"""Control theory of the paper's law: gains, stability, feedbacks, basins, Lyapunov functions."""

from standoff_studies.paper.control.basins import attraction
from standoff_studies.paper.control.feedbacks import four_feedbacks
from standoff_studies.paper.control.gains import decay_and_lag
from standoff_studies.paper.control.levels import lyapunov
from standoff_studies.paper.control.lower import lower_limit
from standoff_studies.paper.control.roots import stability

__all__ = ["attraction", "decay_and_lag", "four_feedbacks", "lower_limit", "lyapunov", "stability"]
