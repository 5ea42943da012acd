"""What the bridge publishes of a run, by observers."""
