"""The frames of the paper's law, called by address as the default law's is (`laws`)."""

from standoff.kernels.compiler.decorators import entry
from standoff.kernels.compiler.entry import INT, REAL
from standoff.kernels.entries.laws import by_record
from standoff.kernels.paper.frame import carried_frame, integrated_frame


@entry(INT, REAL, work="paper")
def paper(record, h):
    """The law integrated by itself."""
    return by_record(integrated_frame, record, h)


@entry(INT, REAL, work="paper")
def carried(record, h):
    """The law integrated with the bodies' motion, by the method that moves them."""
    return by_record(carried_frame, record, h)
