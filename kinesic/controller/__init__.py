"""Performs a plan in the twin and on servos: the one loop, feed-forward, observer, and what was measured."""
