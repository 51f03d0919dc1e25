"""Choosing levels and programs, and the progress made at them."""
