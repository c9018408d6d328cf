"""Many pairs at once: loops over rows that the compiler turns into vector instructions.

A loop's body is the mathematics of one row, by the functions of a single pair, without a branch
that one row takes and another not. What a row comes to is weighed at the end; a row that is not
proven there is left to the general code.
"""
