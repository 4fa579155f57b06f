"""Experiments without a robot's clock: gestures alone, sweeps, and a perception study."""
