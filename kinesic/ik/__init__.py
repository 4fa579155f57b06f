"""Finds joint angles for a reach."""
