"""The actions of Nav2 that the navigator serves, and those that it refuses."""
