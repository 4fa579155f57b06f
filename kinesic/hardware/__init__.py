"""Servos on a wire."""
