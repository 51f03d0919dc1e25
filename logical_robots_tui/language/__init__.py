"""Programs as text and as a typed tree: parsing, types, checks and messages."""
