"""Other packages' answers for the ready-made shapes, in Standoff's conventions.

Each package is imported only when it is asked (``pip install 'standoff-studies[peers]'``).
"""
