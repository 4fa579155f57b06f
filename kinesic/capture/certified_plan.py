"""Conversion of certified motion files to plans."""

from time import perf_counter

from kinesic.bml.block import Block, Notice, NoticeType
from kinesic.bml.schedule import schedule
from kinesic.capture.certification import Certification, certify_clip
from kinesic.capture.clip import Clip
from kinesic.capture.reading.text import CaptureError
from kinesic.expressivity.keyframes import KeyFrames
from kinesic.planning.clearance import scan_clearance
from kinesic.planning.plan import Plan
from kinesic.planning.postures import Postures
from kinesic.planning.setup import Setup
from kinesic.planning.syncs import Syncs

NOTICED_STRETCH = 1.005  # duration / original duration above which a notice reports the stretch
NOTICED_DISTANCE = 0.05  # [arm lengths] wrist distance from the file's path that causes a notice


def plan_captured(clip: Clip, setup: Setup, *, source: str) -> Plan:
    """Plan the nearest feasible motion to a clip, from rest to rest.

    Args:
        clip: of a body or of the robot's own joints.
        setup: robot and limits.
        source: file name, for messages.

    Raises:
        CaptureError: the clip is too long, has no joint of the robot, or no motion within all limits was found.
    """
    began = perf_counter()
    certification = certify_clip(clip, setup, source)
    _check_certified(certification)
    nearest, timeline = certification.nearest, schedule(Block(id="motion", behaviours=(), source=source), {}, {})
    times, clearance = scan_clearance(certification.trajectory, setup.distances)
    return Plan(
        setup=setup,
        timeline=timeline,
        utterances={},
        keyframes=KeyFrames(timeline, (), {}),
        postures=Postures(nearest.keys, {}),
        motion=nearest.motion,
        clearance=clearance,
        clearance_times=times,
        syncs=Syncs(),
        notices=list_notices(certification),
        seconds=perf_counter() - began,
        requested_postures=nearest.keys,
    )


def _check_certified(certification: Certification) -> None:
    """Raise an error if the nearest motion violates a limit.

    Raises:
        CaptureError: it does; the message has the values.
    """
    if not certification.is_certified:
        raise CaptureError(
            f"{certification.source}: no motion within all limits found: clearance "
            f"{1000.0 * certification.clearance:.0f} mm of {1000.0 * certification.setup.robot.min_clearance:.0f} mm, "
            f"value / limit {certification.limit_ratio:.3f}, drive duty {certification.torque_ratio:.2f}; "
            "`kinesic certify` lists what the file violates"
        )


def list_notices(certification: Certification) -> tuple[Notice, ...]:
    """List notices about a motion's guesses, time stretch and wrist distance."""
    texts = list(certification.desired.notes)
    nearest, distance = certification.nearest, certification.distance
    if nearest.total_stretch > NOTICED_STRETCH:
        texts.append(
            f"faster than the servos: it lasts {nearest.total_stretch:.2f} times as long, "
            f"and is at most {float(nearest.stretch.max()):.2f} times slower"
        )
    if distance.wrist_max > NOTICED_DISTANCE:
        texts.append(f"a wrist is up to {distance.wrist_max:.2f} arm lengths away from that of the file")
    return tuple(Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, "motion", text) for text in texts)
