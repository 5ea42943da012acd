"""Driving by hand: keys of a terminal or of MuJoCo's window as commands."""
