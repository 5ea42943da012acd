"""A robot: the entry point is the path of its YAML."""

from pathlib import Path

MINI_CART = Path(__file__).with_name("mini_cart.yaml")
