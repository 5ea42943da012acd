"""Public benchmarks of navigation as suites: their worlds, their rules and their scoring."""
