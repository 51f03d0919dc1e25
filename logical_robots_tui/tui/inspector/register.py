"""The pages of the inspector, in the order of its list; importing this loads none of them."""

from __future__ import annotations

from logical_robots_tui.tui.inspector.page import PageEntry

PAGES = (
    PageEntry("robots", "Robots", "robot", "RobotsPage"),
    PageEntry("decision", "Decision", "robot", "DecisionPage"),
    PageEntry("why", "Why", "robot", "WhyPage"),
    PageEntry("ask", "Ask", "always", "AskPage"),
    PageEntry("watch", "Watch", "robot", "WatchPage"),
    PageEntry("diagnosis", "Diagnosis", "always", "DiagnosisPage"),
    PageEntry("origin", "Origin", "value", "OriginPage"),
    PageEntry("predicate", "", "predicate", "PredicatePage"),
)
"""The first one is shown at first, and loaded at once; the others are when they are needed."""
