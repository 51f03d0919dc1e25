"""The inspector: what the robots see, think and remember."""
