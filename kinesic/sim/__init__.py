"""The virtual robot: a MuJoCo twin of the same skeleton."""

from kinesic.sim import gl

gl.prepare()  # before any module of this room imports mujoco
