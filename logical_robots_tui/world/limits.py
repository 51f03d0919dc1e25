"""Limits on levels of either format."""

from __future__ import annotations

__all__ = [
    "LONGEST_NAME",
    "LONGEST_TEXT",
    "MOST_BYTES",
    "MOST_OF_A_KIND",
    "MOST_OF_A_NUMBER",
    "MOST_SIDE",
]

MOST_SIDE = 4000
"""Largest width and height in map units."""

MOST_OF_A_KIND = 1000
"""Largest number of robots, beacons, areas or hints."""

MOST_OF_A_NUMBER = 1_000_000

LONGEST_NAME = 60
"""Characters."""

LONGEST_TEXT = 20_000
"""Characters of a briefing, a lesson or a hint."""

MOST_BYTES = 64 * 2**20
"""Largest size of a level file."""
