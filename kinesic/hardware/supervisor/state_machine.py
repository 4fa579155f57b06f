"""Decides what the supervisor does next: a state machine as a pure function of state, event and observation.

Theorems, which the tests hold it to: nothing is energised before the manifest is right; an emergency stop wins over
everything; no torque is taken while a limb is raised, unless a person wants it; after a long interruption nothing goes
on without consent; every state leads to release, or to a hold that says what it waits for.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from enum import Enum
from typing import Literal

from kinesic.hardware.supervisor.observation import Observation


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
    WAITING = "waiting"  # a limb is raised and cannot fold: holds until a person lets it fall, or it can fold again
    RELEASE = "release"  # torque goes, of every servo
    STOPPED = "stopped"  # by an emergency stop: holds until a person lets it go on, or end
    LOST = "lost"  # a port is gone; its servos stop by themselves
    IDENTIFY = "identify"  # it is back: are its servos the same?
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
    "mended",  # a servo that had failed, or was silent, is well again
    "resumed",  # a person or client consents that it goes on
]

Action = Literal[
    "check", "configure", "arm", "identify", "adopt", "hold", "approach", "follow", "slow", "fold", "release", "close"
]

Awaited = Literal["nothing", "commands", "servos", "port", "consent", "confirmation"]


@dataclass(frozen=True)
class SupervisorState:
    """Where the supervisor is, and what it must not forget."""

    stage: Stage = Stage.CLOSED
    checked: bool = False  # the servos are those of the manifest
    powered: bool = False  # torque has been switched on, or found on
    armed: bool = False  # all torque has come once: from now on, an interruption is one
    stopped: bool = False  # there was an emergency stop
    paused: bool = False  # there was one, or a long interruption: nothing goes on without consent
    faulty: bool = False  # a servo has failed: nothing is performed any more
    refused: bool = False  # a servo did not take its torque: that is not tried again before something is mended
    careful: bool = False  # what could not fold can again, by somebody's hand perhaps: it holds a while before
    folded: bool = False  # at rest since the last performance
    slowed: Literal[Stage.APPROACH, Stage.ACTIVE] = Stage.ACTIVE  # what came to be degraded


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
    state = _note(state, event, facts)
    if event == "estop":
        return _stop(state, facts)
    if event == "lost" and state.stage in POWERED:
        return _to(state, Stage.LOST, "slow")
    if event == "tripped" and state.stage in POWERED - {Stage.LOST, Stage.IDENTIFY, Stage.ARM, Stage.ADOPT}:
        return _to(state, Stage.ADOPT, "adopt")
    return _RULES[state.stage](state, event, facts)


def _note(state: SupervisorState, event: Event, facts: Observation) -> SupervisorState:
    """Remembers what outlasts the stage."""
    if event == "failed":
        state = replace(state, faulty=True)
    if event == "resumed":
        state = replace(state, stopped=False, paused=False)
    if event in ("mended", "resumed"):
        state = replace(state, refused=False)
    if facts.interrupted and state.armed and state.stage in POWERED:
        state = replace(state, paused=True)
    return state


def _to(state: SupervisorState, stage: Stage, *actions: Action) -> Step:
    return replace(state, stage=stage), actions


def _stop(state: SupervisorState, facts: Observation) -> Step:
    """An emergency stop: what has torque holds or goes limp; what has none gets none, unless a limb is raised."""
    state = replace(state, stopped=True, paused=True)
    if state.stage in (Stage.CLOSED, Stage.RELEASE):
        return state, ()
    if not state.checked:
        return _to(state, Stage.CLOSED, "close")
    if facts.policy == "limp" or (state.stage is Stage.ARM and not facts.raised):
        return _to(state, Stage.RELEASE, "release")
    if state.stage in (Stage.LOST, Stage.IDENTIFY, Stage.ARM, Stage.ADOPT):  # which move nothing
        return state, ()
    return _to(state, Stage.STOPPED, "slow") if state.stage in POWERED else _to(state, Stage.CLOSED, "close")


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
    if event not in ("done", "refused"):
        return state, ()
    if event == "refused":
        state = replace(state, faulty=True, refused=True)
    return _to(replace(state, armed=True), Stage.HOLD, "hold")


def _hold(state: SupervisorState, event: Event, facts: Observation) -> Step:
    if not facts.energised and (state.faulty or not facts.limp):
        return _to(state, Stage.RELEASE, "release")
    if state.stopped and not facts.dismissed:
        return _to(state, Stage.STOPPED, "hold")
    if _may_arm(state, facts):
        return _to(replace(state, folded=False), Stage.ARM, "arm")
    if facts.over or state.faulty:
        return _end(state, facts)
    if facts.due and facts.well and not state.paused:
        return _to(replace(state, folded=False), Stage.APPROACH, "approach")
    if facts.idle and not state.folded:
        return _to(state, Stage.FOLD, "fold")
    return state, ()


def _may_arm(state: SupervisorState, facts: Observation) -> bool:
    """Whether limp servos get torque: to go on, or, without anybody's consent, to keep a raised limb from falling."""
    wanted = facts.raised or not (state.paused or state.faulty or facts.over)
    return facts.limp and facts.answering and not state.refused and not facts.confirmed and wanted


def _end(state: SupervisorState, facts: Observation) -> Step:
    """Folds, then lets go; what is raised all the same is held until a person lets it fall."""
    if not state.folded:
        now = not state.paused or facts.release or facts.confirmed
        return _to(state, Stage.FOLD, "fold") if facts.idle or (now and not state.careful) else (state, ())
    if not facts.raised or facts.confirmed:
        return _to(state, Stage.RELEASE, "release")
    return _to(state, Stage.WAITING) if facts.idle else (state, ())  # it may still be settling


def _waiting(state: SupervisorState, event: Event, facts: Observation) -> Step:
    if facts.confirmed or not facts.raised:
        return _to(state, Stage.RELEASE, "release")
    if event == "resumed":
        return _to(replace(state, folded=False), Stage.HOLD, "hold")
    if event == "mended" or _may_arm(state, facts):
        return _to(replace(state, folded=False, careful=True), Stage.HOLD, "hold")
    return state, ()


def _approach(state: SupervisorState, event: Event, facts: Observation) -> Step:
    if _must_stop(state, facts):
        return _to(replace(state, slowed=Stage.APPROACH), Stage.DEGRADED, "slow")
    return _to(state, Stage.ACTIVE, "follow") if facts.reached else (state, ())


def _active(state: SupervisorState, event: Event, facts: Observation) -> Step:
    if _must_stop(state, facts):
        return _to(replace(state, slowed=Stage.ACTIVE), Stage.DEGRADED, "slow")
    return state, ()


def _degraded(state: SupervisorState, event: Event, facts: Observation) -> Step:
    if facts.still:
        return _to(state, Stage.HOLD, "hold")
    return (state, ()) if _must_stop(state, facts) else _to(state, state.slowed)


def _must_stop(state: SupervisorState, facts: Observation) -> bool:
    return facts.over or state.faulty or state.paused or not (facts.well and facts.due)


def _fold(state: SupervisorState, event: Event, facts: Observation) -> Step:
    if event == "failed":  # its chain may have to hold from now on
        return _to(state, Stage.FOLD, "fold")
    return _to(replace(state, folded=True, careful=False), Stage.HOLD, "hold") if facts.reached else (state, ())


def _release(state: SupervisorState, event: Event, facts: Observation) -> Step:
    if event == "refused":  # some are not sure to be limp, after all that could be done
        return _to(state, Stage.CLOSED, "close")
    if event != "done":
        return state, ()
    return _to(replace(state, powered=False), Stage.CLOSED, "close")


def _stopped(state: SupervisorState, event: Event, facts: Observation) -> Step:
    if event == "resumed" or facts.dismissed:
        return _to(replace(state, folded=False), Stage.HOLD, "hold")
    return state, ()


def _lost(state: SupervisorState, event: Event, facts: Observation) -> Step:
    if event == "back":
        return _to(state, Stage.IDENTIFY, "identify")
    return _to(state, Stage.CLOSED, "close") if facts.hopeless else (state, ())


def _identify(state: SupervisorState, event: Event, facts: Observation) -> Step:
    if event == "done":
        return _to(state, Stage.ADOPT, "adopt")
    return _to(state, Stage.LOST, "slow") if event == "refused" else (state, ())


def _adopt(state: SupervisorState, event: Event, facts: Observation) -> Step:
    if event not in ("done", "refused"):
        return state, ()
    faulty = state.faulty or event == "refused"
    return _to(replace(state, armed=True, faulty=faulty, folded=False), Stage.HOLD, "hold")


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
    Stage.WAITING: _waiting,
    Stage.RELEASE: _release,
    Stage.STOPPED: _stopped,
    Stage.LOST: _lost,
    Stage.IDENTIFY: _identify,
    Stage.ADOPT: _adopt,
}
