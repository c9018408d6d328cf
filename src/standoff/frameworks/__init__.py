"""What `standoff.jax`, `standoff.torch` and `standoff.casadi` share, in NumPy."""
