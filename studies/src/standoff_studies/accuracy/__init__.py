"""Errors of distance, witness points and normal for pairs that are exact by construction.

The truth comes from support functions (`standoff_studies.oracles`), not from any kernel or surface.
"""
