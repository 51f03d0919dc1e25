"""Shipped reference programs with one planted bug each, and what the diagnosis says of them."""
