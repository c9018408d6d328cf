"""The table of times and errors beside other packages: ``make bench``."""
