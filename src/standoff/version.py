"""The version: of the package, of its recordings and of its reports."""

__version__ = "0.2.0"
