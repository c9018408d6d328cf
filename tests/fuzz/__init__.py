"""Wild input for the readers and constructors: mutations, the laws they must keep, a corpus.

``python -m benchmarks.fuzz`` runs them for long; docs/fuzzing.md says how.
"""
