"""Recovery of unsaved work after a session that ended badly."""
