"""Compiled numerical code, with one module for each calling package."""

from kinesic._kernel import compiled

controller, ik, metrics, motion, sim = compiled.controller, compiled.ik, compiled.metrics, compiled.motion, compiled.sim

__all__ = ["controller", "ik", "metrics", "motion", "sim"]
