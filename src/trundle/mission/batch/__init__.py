"""Missions that a kernel drives as a whole, and what it leaves to a session."""
