"""The timeline: where one stands in history, what happened when, and what a run stops at."""
