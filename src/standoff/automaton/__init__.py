"""The hybrid automaton that a run went through: features and switches, as a graph."""

from typing import TYPE_CHECKING

from standoff.on_demand import on_demand

if TYPE_CHECKING:
    from standoff.automaton.graph import Automaton, Transition
    from standoff.automaton.visits import Visit
else:
    __getattr__, __dir__ = on_demand(
        __name__,
        {
            "standoff.automaton.graph": (
                "Automaton",
                "Transition",
            ),
            "standoff.automaton.visits": ("Visit",),
        },
    )

__all__ = [
    "Automaton",
    "Transition",
    "Visit",
]
