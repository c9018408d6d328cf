"""The frame of the default law, compiled when a tracker first asks for it and called by its address
(`frames.frame`)."""

from standoff.kernels.compiler.decorators import entry, kernel
from standoff.kernels.compiler.entry import INT, REAL
from standoff.kernels.frame.apart import predicted_frame
from standoff.kernels.frame.record import read_call


@kernel
def by_record(frame, record, h):
    call = read_call(record)
    frame(call.pair, call.inputs, h, call.options, call.state, call.out, call.work)
    return 1


@entry(INT, REAL, work="law")
def predicted(record, h):
    """The predictor-corrector."""
    return by_record(predicted_frame, record, h)
