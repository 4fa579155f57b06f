"""State machine of the supervisor.

It is a pure function of state, event and observation. Tests check these theorems: nothing is energised before the
manifest is verified; an emergency stop has priority over everything; torque is not removed while a limb is raised,
unless a person confirms it; after a long interruption the motion continues only on a resume request; every state ends
in release, or in a hold that reports the input it waits for.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from enum import Enum
from typing import Literal

from kinesic.hardware.supervisor.observation import Observation


class Stage(Enum):
    """Operating stage of the supervisor, a state of its state machine."""

    CLOSED = "closed"  # no port is open
    PROBE = "probe"  # servos are compared with the manifest
    CONFIGURE = "configure"  # registers are set, without torque
    LIMP = "limp"  # registers are set, torque is off
    ARM = "arm"  # torque is switched on at the present positions, with low power first
    HOLD = "hold"  # goals stand still
    APPROACH = "approach"  # the robot moves to the current point of the performance
    ACTIVE = "active"  # performance time runs
    DEGRADED = "degraded"  # performance time decelerates to a stop
    FOLD = "fold"  # the robot moves to the rest posture
    WAITING = "waiting"  # a raised limb cannot move to rest and is held until a person confirms or it can move again
    RELEASE = "release"  # torque is switched off
    STOPPED = "stopped"  # emergency stop: the robot holds until a person resumes or ends the performance
    LOST = "lost"  # a port is gone; its servos stop by themselves
    IDENTIFY = "identify"  # the servos behind a reopened port are identified
    ADOPT = "adopt"  # servos with torque are taken over at their positions

    @property
    def runs(self) -> bool:
        """Whether performance time runs or decelerates."""
        return self in (Stage.ACTIVE, Stage.DEGRADED)


Event = Literal[
    "tick",  # no event besides the observation
    "open",  # request to open the ports
    "done",  # the procedure of the stage has succeeded
    "refused",  # the procedure of the stage has failed
    "estop",
    "lost",  # a port is gone
    "back",  # all ports are open again
    "tripped",  # a bus watchdog has stopped servos
    "failed",  # a servo has shut down or is blocked
    "mended",  # a failed or silent servo is well again
    "resumed",  # a person or client requests to continue
]

Action = Literal[
    "check", "configure", "arm", "identify", "adopt", "hold", "approach", "follow", "slow", "fold", "release", "close"
]

Awaited = Literal["nothing", "commands", "servos", "port", "consent", "confirmation"]


@dataclass(frozen=True)
class SupervisorState:
    """Stage of the supervisor, and the data kept across stages."""

    stage: Stage = Stage.CLOSED
    checked: bool = False  # the servos match the manifest
    powered: bool = False  # torque has been switched on, or was on before
    armed: bool = False  # all servos have had torque, so that interruptions count from now on
    stopped: bool = False  # an emergency stop is active
    paused: bool = False  # after an emergency stop or long interruption, the motion continues only on a resume request
    faulty: bool = False  # a servo has failed, and the performance has ended
    refused: bool = False  # torque did not come on, and is not tried again until a servo recovers
    careful: bool = False  # hold for a while before the move to rest, since a blocked limb may be free again
    folded: bool = False  # at rest since the last performance
    slowed: Literal[Stage.APPROACH, Stage.ACTIVE] = Stage.ACTIVE  # stage before DEGRADED


Step = tuple[SupervisorState, tuple[Action, ...]]

POWERED_STAGES = frozenset(Stage) - {Stage.CLOSED, Stage.PROBE, Stage.CONFIGURE, Stage.LIMP, Stage.RELEASE}
"""Stages in which servos may have torque."""

MOVING_STAGES = frozenset({Stage.APPROACH, Stage.ACTIVE, Stage.FOLD})  # Stages in which a move or performance runs


def step(state: SupervisorState, event: Event, observation: Observation) -> Step:
    """Return the supervisor's next state, and the actions that begin.

    Args:
        state: current state.
        event: event of this step.
        observation: further inputs.
    """
    state = _remember(state, event, observation)
    if event == "estop":
        return _stop(state, observation)
    if event == "lost" and state.stage in POWERED_STAGES:
        return _to(state, Stage.LOST, "slow")
    if event == "tripped" and state.stage in POWERED_STAGES - {Stage.LOST, Stage.IDENTIFY, Stage.ARM, Stage.ADOPT}:
        return _to(state, Stage.ADOPT, "adopt")
    return _STAGE_RULES[state.stage](state, event, observation)


def _remember(state: SupervisorState, event: Event, observation: Observation) -> SupervisorState:
    """Update the supervisor flags that persist when the stage changes."""
    if event == "failed":
        state = replace(state, faulty=True)
    if event == "resumed":
        state = replace(state, stopped=False, paused=False)
    if event in ("mended", "resumed"):
        state = replace(state, refused=False)
    if observation.interrupted and state.armed and state.stage in POWERED_STAGES:
        state = replace(state, paused=True)
    return state


def _to(state: SupervisorState, stage: Stage, *actions: Action) -> Step:
    return replace(state, stage=stage), actions


def _stop(state: SupervisorState, observation: Observation) -> Step:
    """Handle an emergency stop.

    Servos with torque hold or switch torque off, by the policy. Other servos get no torque, unless a limb is raised.
    """
    state = replace(state, stopped=True, paused=True)
    if state.stage in (Stage.CLOSED, Stage.RELEASE):
        return state, ()
    if not state.checked:
        return _to(state, Stage.CLOSED, "close")
    if observation.policy == "limp" or (state.stage is Stage.ARM and not observation.raised):
        return _to(state, Stage.RELEASE, "release")
    if state.stage in (Stage.LOST, Stage.IDENTIFY, Stage.ARM, Stage.ADOPT):  # these stages move nothing
        return state, ()
    return _to(state, Stage.STOPPED, "slow") if state.stage in POWERED_STAGES else _to(state, Stage.CLOSED, "close")


def _closed(state: SupervisorState, event: Event, observation: Observation) -> Step:
    if event == "open":
        return SupervisorState(Stage.PROBE), ("check",)
    return state, ()


def _probe(state: SupervisorState, event: Event, observation: Observation) -> Step:
    if event == "refused":
        return _to(state, Stage.CLOSED, "close")
    if event != "done":
        return state, ()
    return _to(replace(state, checked=True), Stage.CONFIGURE, "configure")


def _configure(state: SupervisorState, event: Event, observation: Observation) -> Step:
    if event == "refused":
        return _to(state, Stage.CLOSED, "close")
    if event != "done":
        return state, ()
    if observation.energised:
        return _to(replace(state, powered=True), Stage.ADOPT, "adopt")
    return _to(state, Stage.LIMP)


def _limp(state: SupervisorState, event: Event, observation: Observation) -> Step:
    if observation.over or state.faulty:
        return _to(state, Stage.CLOSED, "close")
    if observation.begun and observation.answering:
        return _to(replace(state, powered=True), Stage.ARM, "arm")
    return state, ()


def _arm(state: SupervisorState, event: Event, observation: Observation) -> Step:
    if event not in ("done", "refused"):
        return state, ()
    if event == "refused":
        state = replace(state, faulty=True, refused=True)
    return _to(replace(state, armed=True), Stage.HOLD, "hold")


def _hold(state: SupervisorState, event: Event, observation: Observation) -> Step:
    if not observation.energised and (state.faulty or not observation.limp):
        return _to(state, Stage.RELEASE, "release")
    if state.stopped and not observation.dismissed:
        return _to(state, Stage.STOPPED, "hold")
    if _may_arm(state, observation):
        return _to(replace(state, folded=False), Stage.ARM, "arm")
    if observation.over or state.faulty:
        return _end(state, observation)
    if observation.due and observation.well and not state.paused:
        return _to(replace(state, folded=False), Stage.APPROACH, "approach")
    if observation.idle and not state.folded:
        return _to(state, Stage.FOLD, "fold")
    return state, ()


def _may_arm(state: SupervisorState, observation: Observation) -> bool:
    """Return whether torque may be switched on for servos without torque.

    They get it to continue, or, without a resume request, to keep a raised limb from falling.
    """
    is_useful = observation.raised or not (state.paused or state.faulty or observation.over)
    return observation.limp and observation.answering and not state.refused and not observation.confirmed and is_useful


def _end(state: SupervisorState, observation: Observation) -> Step:
    """Move to rest, then switch torque off unless a limb stays raised.

    A limb that stays raised waits for confirmation.
    """
    if not state.folded:
        may_fold = not state.paused or observation.release or observation.confirmed
        return _to(state, Stage.FOLD, "fold") if observation.idle or (may_fold and not state.careful) else (state, ())
    if not observation.raised or observation.confirmed:
        return _to(state, Stage.RELEASE, "release")
    return _to(state, Stage.WAITING) if observation.idle else (state, ())  # the limb may still be settling


def _waiting(state: SupervisorState, event: Event, observation: Observation) -> Step:
    if observation.confirmed or not observation.raised:
        return _to(state, Stage.RELEASE, "release")
    if event == "resumed":
        return _to(replace(state, folded=False), Stage.HOLD, "hold")
    if event == "mended" or _may_arm(state, observation):
        return _to(replace(state, folded=False, careful=True), Stage.HOLD, "hold")
    return state, ()


def _approach(state: SupervisorState, event: Event, observation: Observation) -> Step:
    if _must_stop(state, observation):
        return _to(replace(state, slowed=Stage.APPROACH), Stage.DEGRADED, "slow")
    return _to(state, Stage.ACTIVE, "follow") if observation.reached else (state, ())


def _active(state: SupervisorState, event: Event, observation: Observation) -> Step:
    if _must_stop(state, observation):
        return _to(replace(state, slowed=Stage.ACTIVE), Stage.DEGRADED, "slow")
    return state, ()


def _degraded(state: SupervisorState, event: Event, observation: Observation) -> Step:
    if observation.still:
        return _to(state, Stage.HOLD, "hold")
    return (state, ()) if _must_stop(state, observation) else _to(state, state.slowed)


def _must_stop(state: SupervisorState, observation: Observation) -> bool:
    return observation.over or state.faulty or state.paused or not (observation.well and observation.due)


def _fold(state: SupervisorState, event: Event, observation: Observation) -> Step:
    if event == "failed":  # the chain of the failed servo may have to hold
        return _to(state, Stage.FOLD, "fold")
    return _to(replace(state, folded=True, careful=False), Stage.HOLD, "hold") if observation.reached else (state, ())


def _release(state: SupervisorState, event: Event, observation: Observation) -> Step:
    if event == "refused":  # some servos may still have torque
        return _to(state, Stage.CLOSED, "close")
    if event != "done":
        return state, ()
    return _to(replace(state, powered=False), Stage.CLOSED, "close")


def _stopped(state: SupervisorState, event: Event, observation: Observation) -> Step:
    if event == "resumed" or observation.dismissed:
        return _to(replace(state, folded=False), Stage.HOLD, "hold")
    return state, ()


def _lost(state: SupervisorState, event: Event, observation: Observation) -> Step:
    if event == "back":
        return _to(state, Stage.IDENTIFY, "identify")
    return _to(state, Stage.CLOSED, "close") if observation.hopeless else (state, ())


def _identify(state: SupervisorState, event: Event, observation: Observation) -> Step:
    if event == "done":
        return _to(state, Stage.ADOPT, "adopt")
    return _to(state, Stage.LOST, "slow") if event == "refused" else (state, ())


def _adopt(state: SupervisorState, event: Event, observation: Observation) -> Step:
    if event not in ("done", "refused"):
        return state, ()
    faulty = state.faulty or event == "refused"
    return _to(replace(state, armed=True, faulty=faulty, folded=False), Stage.HOLD, "hold")


_STAGE_RULES: Mapping[Stage, Callable[[SupervisorState, Event, Observation], Step]] = {
    Stage.CLOSED: _closed,
    Stage.PROBE: _probe,
    Stage.CONFIGURE: _configure,
    Stage.LIMP: _limp,
    Stage.ARM: _arm,
    Stage.HOLD: _hold,
    Stage.APPROACH: _approach,
    Stage.ACTIVE: _active,
    Stage.DEGRADED: _degraded,
    Stage.FOLD: _fold,
    Stage.WAITING: _waiting,
    Stage.RELEASE: _release,
    Stage.STOPPED: _stopped,
    Stage.LOST: _lost,
    Stage.IDENTIFY: _identify,
    Stage.ADOPT: _adopt,
}
