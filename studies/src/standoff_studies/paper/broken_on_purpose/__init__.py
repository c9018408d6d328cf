"""The law broken on purpose, and which statements of Figs. 6 to 20 detect it: a test of the audit.

``python -m standoff_studies.paper.broken_on_purpose`` prints the table.
"""

from standoff_studies.paper.broken_on_purpose.breaks import BREAKS, Break, broken
from standoff_studies.paper.broken_on_purpose.matrix import FIGURES, Noticed, noticed

__all__ = ["BREAKS", "FIGURES", "Break", "Noticed", "broken", "noticed"]
