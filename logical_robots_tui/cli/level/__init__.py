"""``logical-robots level``: making, checking, converting and showing levels."""
