"""Writing worlds as USD stages, and the additions that Isaac Sim needs. `worlds.usd` reads stages."""
