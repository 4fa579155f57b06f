"""Simulated twin of the robot in MuJoCo."""

from kinesic.sim import gl

gl.prepare()  # before any module of this room imports mujoco
