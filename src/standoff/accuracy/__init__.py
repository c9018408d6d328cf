"""Errors of distance, witness points and normal against pairs exact by construction.

Beside `standoff.paper` among the layers. The truth comes from support functions of its own
(`supports`, `round_supports`), from no kernel and no surface.
"""
