"""A stand-in for Nav2's package of this name, of which PyPI has no wheel."""
