"""Long random runs that check every answer by support functions: ``standoff soak``."""
