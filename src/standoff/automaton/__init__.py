"""The hybrid automaton that a run went through: features and switches, as a graph.

Of solids one for each local minimum, in parallel.
"""

from typing import TYPE_CHECKING

from standoff.on_demand import on_demand

if TYPE_CHECKING:
    from standoff.automaton.branches import BranchAutomaton, BranchEvent
    from standoff.automaton.graph import Automaton
    from standoff.automaton.parallel import SolidAutomaton
    from standoff.automaton.transitions import Transition
    from standoff.automaton.visits import Visit
else:
    __getattr__, __dir__ = on_demand(__name__)

__all__ = [
    "Automaton",
    "BranchAutomaton",
    "BranchEvent",
    "SolidAutomaton",
    "Transition",
    "Visit",
]
