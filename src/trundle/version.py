"""The version of trundle; a test holds it equal to that of the distribution."""

__version__ = "0.1.0"
