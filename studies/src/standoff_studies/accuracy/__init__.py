"""Errors of distance, witness points and normal against pairs exact by construction.

The truth comes from support functions
(`standoff_studies.oracles`), from no kernel and no surface.
"""
