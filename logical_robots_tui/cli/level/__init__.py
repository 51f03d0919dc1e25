"""``logical-robots level``: create, check, convert and show levels."""
