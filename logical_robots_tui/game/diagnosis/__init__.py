"""Diagnosis: scanning a run for likely mistakes."""
