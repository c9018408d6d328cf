"""Rows that one thread publishes and another reads, neither of them waiting for the other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from standoff.kernels.dynamics import servo_arrays as V
from standoff.kernels.entries import servo as entries
from standoff.typing import Array


class Mailbox:
    """The newest row of one writer, for any number of readers.

    The writer goes round a few rows and then publishes the number of the newest. A reader copies
    that row and looks at the number again: if the writer has come round to the row meanwhile, the
    copy is discarded. So no lock is taken, and a thread that is delayed in the middle of a row
    delays nobody. Numbers and rows are passed by the processor's own acquire and release, in
    compiled code on both sides.

    Parameters
    ----------
    width : int
        Numbers of a row.
    """

    def __init__(self, width: int) -> None:
        self.newest = np.zeros(8, dtype=np.int64)  # a cache line of its own
        self.rows = np.zeros((V.BOX_ROWS, width))

    @property
    def arrays(self) -> tuple[NDArray[np.int64], Array]:
        """As the compiled loop takes it."""
        return self.newest, self.rows

    def put(self, row: Array) -> None:
        """Publish a row; one thread at a time."""
        entries.put_row(self.newest, self.rows, row)

    def newest_row(self) -> Array | None:
        """Return a copy of the newest row; None where there is none yet."""
        row = np.empty(self.rows.shape[1])
        number = entries.take_row(self.newest, self.rows, 0, row)
        while number < 0:
            number = entries.take_row(self.newest, self.rows, 0, row)
        return row if number > 0 else None
