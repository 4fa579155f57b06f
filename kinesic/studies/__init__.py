"""Experiments that need no real time: gestures played alone, sweeps, and studies of perception."""
