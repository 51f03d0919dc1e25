"""The timeline: the history, its events, breakpoints and searches."""
