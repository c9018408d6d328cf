"""Measurements of Standoff beside other packages."""
