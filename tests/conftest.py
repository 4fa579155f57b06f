"""MuJoCo reads MUJOCO_GL when it is first imported: kinesic decides before any test module can."""

from kinesic.sim import gl

gl.prepare()
