"""Generated worlds, and the props that stand in them."""
