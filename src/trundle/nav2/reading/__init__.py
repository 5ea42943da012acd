"""From Nav2's parameters to a scenario's settings, one file for each part of Nav2."""
