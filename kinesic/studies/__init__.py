"""Offline experiments: isolated gestures, sweeps, and perception studies."""
