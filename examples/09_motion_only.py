"""Compute a motion within limits from key postures, without a robot."""

import numpy as np

from kinesic import motion

limits = motion.Limits.box(  # limits of two joints
    lower=np.array([-1.5, -0.2]),  # [rad]
    upper=np.array([1.5, 2.4]),
    speed=np.array([2.0, 3.0]),  # [rad/s]
    acceleration=np.array([8.0, 12.0]),  # [rad/s^2]
    jerk=np.array([200.0, 300.0]),  # [rad/s^3]
)
keys = (
    motion.KeyPosture.whole(0.0, [0.0, 0.0]),
    motion.KeyPosture.whole(0.5, [1.2, 2.0]),  # infeasible in time, so planned as early as possible
    motion.KeyPosture.whole(2.5, [-0.4, 0.3]),
    motion.KeyPosture.whole(3.5, [0.0, 0.0]),
)
result = motion.condition(keys, limits)
for key, planned in zip(keys, result.planned, strict=True):
    angles = result.trajectory.at(planned + result.trajectory.zero).angles
    print(f"requested at {key.time:.2f} s, planned at {planned:.2f} s: {np.round(angles, 3) + 0.0} rad")

times = np.arange(0.0, result.trajectory.duration, 0.001)
_, velocities, accelerations = result.trajectory.sample(times)
print(
    f"velocity at most {np.abs(velocities).max(axis=0)} rad/s, acceleration {np.abs(accelerations).max(axis=0)} rad/s^2"
)
