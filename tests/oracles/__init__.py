"""Independent ground truth for the tests.

Nothing here imports ``standoff``: these modules judge it. The support functions of the ready-made
shapes are `standoff_studies.oracles`, which the soak and the accuracy report share. Only NumPy and
SciPy are used, and the methods differ from the library's own: support functions, cutting planes on
the Minkowski difference, sequential quadratic programming and enumeration of features.
"""
