"""A run in progress: the session, its goals, its log, and the episode that it becomes."""
