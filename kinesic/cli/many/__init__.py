"""Verbs that run many tasks, with their workers and result tables."""
