"""Motion without a robot: postures and their times go in, a motion that keeps every limit comes out."""

import numpy as np

from kinesic import motion

limits = motion.Limits.box(  # of two hinges
    lower=np.array([-1.5, -0.2]),  # [rad]
    upper=np.array([1.5, 2.4]),
    speed=np.array([2.0, 3.0]),  # [rad/s]
    acceleration=np.array([8.0, 12.0]),  # [rad/s^2]
    jerk=np.array([200.0, 300.0]),  # [rad/s^3]
)
keys = (
    motion.KeyPosture.whole(0.0, [0.0, 0.0]),
    motion.KeyPosture.whole(0.5, [1.2, 2.0]),  # too soon: it comes as early as it can
    motion.KeyPosture.whole(2.5, [-0.4, 0.3]),
    motion.KeyPosture.whole(3.5, [0.0, 0.0]),
)
found = motion.condition(keys, limits)
for key, planned in zip(keys, found.planned, strict=True):
    angles = found.trajectory.at(planned + found.trajectory.zero).angles
    print(f"asked at {key.time:.2f} s, passed at {planned:.2f} s: {np.round(angles, 3) + 0.0} rad")

times = np.arange(0.0, found.trajectory.duration, 0.001)
_, speeds, accelerations = found.trajectory.sample(times)
print(f"speed at most {np.abs(speeds).max(axis=0)} rad/s, acceleration {np.abs(accelerations).max(axis=0)} rad/s^2")
