"""Control theory of the paper's law: gains, stability, feedbacks, basins, Lyapunov functions."""

from standoff.paper.control.basins import attraction
from standoff.paper.control.feedbacks import four_feedbacks
from standoff.paper.control.gains import decay_and_lag
from standoff.paper.control.levels import lyapunov
from standoff.paper.control.roots import stability

__all__ = ["attraction", "decay_and_lag", "four_feedbacks", "lyapunov", "stability"]
