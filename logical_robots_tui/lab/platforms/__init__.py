"""Learning platforms: their exports, tables of students and dates, and whose a submission is."""
