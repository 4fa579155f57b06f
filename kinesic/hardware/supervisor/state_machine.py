"""Decides what the supervisor does next: a state machine as a pure function of state, event and observation.

Theorems, which the tests hold it to: nothing is energised before the manifest is right; every state leads to rest or
to release; an emergency stop wins over everything.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from enum import Enum
from typing import Literal

from kinesic.hardware.supervisor.settings import Policy


class Stage(Enum):
    """Where the supervisor is."""

    CLOSED = "closed"  # it has no port
    PROBE = "probe"  # are the servos those of the manifest?
    CONFIGURE = "configure"  # their registers are set, without torque
    LIMP = "limp"  # all is set, no torque
    ARM = "arm"  # torque comes, at low power first, where the servos are
    HOLD = "hold"  # goals stand still
    APPROACH = "approach"  # to where the performance begins, or goes on
    ACTIVE = "active"  # performance time runs
    DEGRADED = "degraded"  # performance time comes to a stop
    FOLD = "fold"  # to the posture of rest
    RELEASE = "release"  # torque goes, of every servo
    STOPPED = "stopped"  # by an emergency stop: holds until it is released
    LOST = "lost"  # a port is gone; its servos stop by themselves
    ADOPT = "adopt"  # servos with torque are taken over where they are

    @property
    def runs(self) -> bool:
        """Whether performance time runs, or comes to a stop."""
        return self in (Stage.ACTIVE, Stage.DEGRADED)


Event = Literal[
    "tick",  # nothing but the facts
    "open",  # somebody wants the servos
    "done",  # what the stage was about has been done
    "refused",  # it cannot be done
    "estop",
    "lost",  # a port
    "back",  # all ports
    "tripped",  # servos were stopped by their bus watchdog
    "failed",  # a servo has shut down, or cannot move
]

Action = Literal["check", "configure", "arm", "adopt", "hold", "approach", "follow", "slow", "fold", "release", "close"]


@dataclass(frozen=True)
class SupervisorState:
    """Where the supervisor is, and what it must not forget."""

    stage: Stage = Stage.CLOSED
    checked: bool = False  # the servos are those of the manifest
    powered: bool = False  # torque has been switched on, or found on
    stopped: bool = False  # there was an emergency stop
    faulty: bool = False  # a servo has failed: nothing is performed any more
    folded: bool = False  # at rest since the last performance
    slowed: Literal[Stage.APPROACH, Stage.ACTIVE] = Stage.ACTIVE  # what came to be degraded


@dataclass(frozen=True)
class Observation:
    """What is known from outside at this instant."""

    energised: bool = False  # some servo has torque
    answering: bool = True  # every servo has answered lately
    well: bool = True  # every servo has torque, answers, and may go on
    limp: bool = False  # some servo that could have torque has none
    begun: bool = False  # there is, or was, something to perform
    due: bool = False  # there is something to perform now, enough ahead
    ended: bool = False  # the planner will send nothing more, and all it sent has been performed or is void
    release: bool = False  # asked to fold and release
    still: bool = True  # time stands
    reached: bool = False  # the end of the present move
    idle: bool = False  # held for so long that it may fold
    hopeless: bool = False  # a port is gone for so long that it will not come back
    policy: Policy = "hold"  # at an emergency stop

    @property
    def over(self) -> bool:
        """Whether the performance is to end."""
        return self.ended or self.release


Step = tuple[SupervisorState, tuple[Action, ...]]

POWERED = frozenset(Stage) - {Stage.CLOSED, Stage.PROBE, Stage.CONFIGURE, Stage.LIMP, Stage.RELEASE}
"""Stages in which servos may have torque."""

MOVING = frozenset({Stage.APPROACH, Stage.ACTIVE, Stage.FOLD})


def step(state: SupervisorState, event: Event, facts: Observation) -> Step:
    """Returns the next state, and what is to be begun on the way there.

    Args:
        state: now.
        event: what has happened.
        facts: what is known besides.
    """
    if event == "failed":
        state = replace(state, faulty=True)
    if event == "estop":
        return _stop(state, facts)
    if event == "lost" and state.stage in POWERED:
        return _to(state, Stage.LOST, "slow")
    if event == "tripped" and state.stage in POWERED - {Stage.LOST, Stage.ARM, Stage.ADOPT}:
        return _to(state, Stage.ADOPT, "adopt")
    return _RULES[state.stage](state, event, facts)


def _to(state: SupervisorState, stage: Stage, *actions: Action) -> Step:
    return replace(state, stage=stage), actions


def _stop(state: SupervisorState, facts: Observation) -> Step:
    """An emergency stop: what has torque holds or goes limp, what has none gets none."""
    state = replace(state, stopped=True)
    if state.stage in (Stage.CLOSED, Stage.RELEASE):
        return state, ()
    if not state.checked:
        return _to(state, Stage.CLOSED, "close")
    if facts.policy == "limp" or state.stage is Stage.ARM:
        return _to(state, Stage.RELEASE, "release")
    if state.stage in POWERED:
        return (state, ()) if state.stage in (Stage.LOST, Stage.ADOPT) else _to(state, Stage.STOPPED, "slow")
    return _to(state, Stage.CLOSED, "close")


def _closed(state: SupervisorState, event: Event, facts: Observation) -> Step:
    if event == "open":
        return SupervisorState(Stage.PROBE), ("check",)
    return state, ()


def _probe(state: SupervisorState, event: Event, facts: Observation) -> Step:
    if event == "refused":
        return _to(state, Stage.CLOSED, "close")
    if event != "done":
        return state, ()
    return _to(replace(state, checked=True), Stage.CONFIGURE, "configure")


def _configure(state: SupervisorState, event: Event, facts: Observation) -> Step:
    if event == "refused":
        return _to(state, Stage.CLOSED, "close")
    if event != "done":
        return state, ()
    if facts.energised:
        return _to(replace(state, powered=True), Stage.ADOPT, "adopt")
    return _to(state, Stage.LIMP)


def _limp(state: SupervisorState, event: Event, facts: Observation) -> Step:
    if facts.over or state.faulty:
        return _to(state, Stage.CLOSED, "close")
    if facts.begun and facts.answering:
        return _to(replace(state, powered=True), Stage.ARM, "arm")
    return state, ()


def _arm(state: SupervisorState, event: Event, facts: Observation) -> Step:
    if event == "done":
        return _to(state, Stage.HOLD, "hold")
    if event == "refused":
        return _to(replace(state, faulty=True), Stage.HOLD, "hold")
    return state, ()


def _hold(state: SupervisorState, event: Event, facts: Observation) -> Step:
    if not facts.energised and (state.faulty or not facts.limp):
        return _to(state, Stage.RELEASE, "release")
    if facts.over or state.faulty:
        return _to(state, Stage.RELEASE, "release") if state.folded else _to(state, Stage.FOLD, "fold")
    if facts.limp and facts.answering:
        return _to(replace(state, folded=False), Stage.ARM, "arm")
    if facts.due and facts.well:
        return _to(replace(state, folded=False), Stage.APPROACH, "approach")
    if facts.idle and not state.folded:
        return _to(state, Stage.FOLD, "fold")
    return state, ()


def _approach(state: SupervisorState, event: Event, facts: Observation) -> Step:
    if facts.over or state.faulty or not (facts.well and facts.due):
        return _to(replace(state, slowed=Stage.APPROACH), Stage.DEGRADED, "slow")
    return _to(state, Stage.ACTIVE, "follow") if facts.reached else (state, ())


def _active(state: SupervisorState, event: Event, facts: Observation) -> Step:
    if facts.over or state.faulty or not (facts.well and facts.due):
        return _to(replace(state, slowed=Stage.ACTIVE), Stage.DEGRADED, "slow")
    return state, ()


def _degraded(state: SupervisorState, event: Event, facts: Observation) -> Step:
    if facts.still:
        return _to(state, Stage.HOLD, "hold")
    if facts.well and facts.due and not (facts.over or state.faulty):
        return _to(state, state.slowed)
    return state, ()


def _fold(state: SupervisorState, event: Event, facts: Observation) -> Step:
    if event == "failed":  # its chain holds from now on
        return _to(state, Stage.FOLD, "fold")
    return _to(replace(state, folded=True), Stage.HOLD, "hold") if facts.reached else (state, ())


def _release(state: SupervisorState, event: Event, facts: Observation) -> Step:
    if event == "refused":  # some are not sure to be limp, after all that could be done
        return _to(state, Stage.CLOSED, "close")
    if event != "done":
        return state, ()
    return _to(replace(state, powered=False), Stage.CLOSED, "close")


def _stopped(state: SupervisorState, event: Event, facts: Observation) -> Step:
    return _to(state, Stage.RELEASE, "release") if facts.over else (state, ())


def _lost(state: SupervisorState, event: Event, facts: Observation) -> Step:
    if event == "back":
        return _to(state, Stage.ADOPT, "adopt")
    return _to(state, Stage.CLOSED, "close") if facts.hopeless else (state, ())


def _adopt(state: SupervisorState, event: Event, facts: Observation) -> Step:
    if event not in ("done", "refused"):
        return state, ()
    faulty = state.faulty or event == "refused"
    state = replace(state, faulty=faulty, folded=False)
    return _to(state, Stage.STOPPED if state.stopped else Stage.HOLD, "hold")


_RULES: Mapping[Stage, Callable[[SupervisorState, Event, Observation], Step]] = {
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
    Stage.RELEASE: _release,
    Stage.STOPPED: _stopped,
    Stage.LOST: _lost,
    Stage.ADOPT: _adopt,
}
