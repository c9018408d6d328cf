"""Settings shared by all tests."""

from hypothesis import settings

# The first call of a compiled function takes seconds, so no example has a deadline. Examples are
# drawn afresh in every run; a failing one is printed with the blob that reproduces it.
settings.register_profile("standoff", deadline=None, derandomize=False, print_blob=True)
settings.load_profile("standoff")
