"""Quality of motion retargeted by mink, under the limits of certified motion."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from kinesic.bench.capture.independent_checks import touches_itself
from kinesic.bench.capture.peer import retarget_by_mink
from kinesic.bench.metric import Metric
from kinesic.capture.certification import MIN_PATH, Certification, correlate
from kinesic.capture.robot_motion import arm_paths
from kinesic.capture.violations import find_violations
from kinesic.extras import install_extra

PEER_LIMITS = ("position", "velocity")  # kinds of limits that mink enforces


@dataclass(frozen=True)
class PeerMotion:
    """Quality of a clip that mink retargeted."""

    violates: bool  # whether the motion exceeds any limit
    violates_own: bool  # whether the motion exceeds a position or velocity limit
    ratio: float  # largest value / limit
    penetrates: bool  # whether segments of the robot touch
    correlation: float  # smallest correlation of wrist paths


def measure_peer(result: Certification) -> PeerMotion:
    """Retarget a certified clip with mink, and measure the motion's quality."""
    setup = result.setup
    angles = retarget_by_mink(result.desired, setup.robot)
    violations = [violation for violation in find_violations(angles, setup) if violation.limit != "clearance"]
    reached = arm_paths(setup.robot, angles)
    paths = [(arm.wrist, reached[side].wrist) for side, arm in result.desired.arms.items()]
    moving = [pair for pair in paths if float(np.ptp(pair[0], axis=0).max()) > MIN_PATH]
    return PeerMotion(
        violates=bool(violations),
        violates_own=any(violation.limit in PEER_LIMITS for violation in violations),
        ratio=max((violation.ratio for violation in violations), default=1.0),
        penetrates=touches_itself(angles, setup.robot),
        correlation=min((correlate(*pair) for pair in moving), default=1.0),
    )


def peer_metrics(prefix: str, peers: Sequence[PeerMotion]) -> list[Metric]:
    """Return the metrics of clips that mink retargeted."""
    why = "" if peers else f"mink is not installed: {install_extra('bench')}"

    def mean(read: Callable[[PeerMotion], float]) -> float | None:
        return float(np.mean([read(peer) for peer in peers])) if peers else None

    return [
        Metric(f"{prefix}_violating", mean(lambda peer: peer.violates), "fraction", None, "lower", why),
        Metric(f"{prefix}_beyond_own", mean(lambda peer: peer.violates_own), "fraction", None, "lower", why),
        Metric(f"{prefix}_penetrating", mean(lambda peer: peer.penetrates), "fraction", None, "lower", why),
        Metric(f"{prefix}_ratio", _percentile([peer.ratio for peer in peers], 50.0), "", None, "lower", why),
        Metric(
            f"{prefix}_correlation_p5", _percentile([peer.correlation for peer in peers], 5.0), "", None, "higher", why
        ),
    ]


def _percentile(values: Sequence[float], percentage: float) -> float | None:
    return float(np.percentile(values, percentage)) if values else None
