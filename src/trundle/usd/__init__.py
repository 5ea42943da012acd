"""Writing USD stages: of worlds, and what Isaac Sim wants of any stage besides. `worlds.usd` reads them."""
