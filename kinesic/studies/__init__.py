"""Experiments that need no real time: gestures played alone, sweeps, and a perception study."""
