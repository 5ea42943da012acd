"""Driving by hand, with keys in a terminal or in MuJoCo's window."""
