"""A virtual coupler as Python calls it: one tick of its law, which a simulated system runs too."""

from standoff.kernels.compiler.decorators import entry, pointer
from standoff.kernels.compiler.entry import READ, REAL, WRITE
from standoff.kernels.dynamics.coupler import Moment, couple


@entry(READ, WRITE, READ, READ, REAL, REAL, work="coupler")
def couple_once(coupler, state, reading, tool, dt, clock):
    """One tick, the state in place; `clock` is nan where the coupler's own serves."""
    moment = Moment(dt, clock, True, dt)
    couple(pointer(coupler, 0), pointer(state, 0), pointer(reading, 0), pointer(tool, 0), moment)
    return len(coupler) + len(state) + len(reading) + len(tool)  # alive until here, see `pointer`
