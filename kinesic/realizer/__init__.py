"""Realizes several blocks over time, as pure functions of a scene and a time."""
