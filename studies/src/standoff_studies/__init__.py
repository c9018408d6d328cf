"""Studies made with Standoff: the paper's figures, the soak, and the accuracy by pair of shapes.

They use the library, which never imports them. Their commands, ``standoff paper``,
``standoff soak`` and ``standoff accuracy``, are entry points of the group ``standoff.commands``.
"""
