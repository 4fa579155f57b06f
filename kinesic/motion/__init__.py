"""Motion planning under limits: key postures in, certified B-splines out."""

from kinesic.body.limits import Limits
from kinesic.motion.condition import Conditioned, condition
from kinesic.motion.keys import KeyPosture
from kinesic.motion.limit_check import check_limits
from kinesic.motion.stopping import stop
from kinesic.motion.trajectory import Trajectory

__all__ = ["Conditioned", "KeyPosture", "Limits", "Trajectory", "check_limits", "condition", "stop"]
