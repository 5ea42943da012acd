"""From a scenario's settings to Nav2's parameters, one file for each part of Nav2."""
