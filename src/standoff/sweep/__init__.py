"""Sweeps: distances of two bodies at very many poses, kept as totals and worst rows."""
