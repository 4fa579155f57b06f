"""Deferred rendering of heads and figures."""
