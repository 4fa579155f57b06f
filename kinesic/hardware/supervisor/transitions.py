"""Transition table of the supervisor, and its evaluation as a pure function.

`FLAG_RULES` update the flags first, then the first row of `TRANSITION_TABLE` applies. Tests check every reachable
state with every event and observation: nothing is energised before the manifest is verified; an emergency stop has
priority over everything; torque is not removed while a limb is raised, unless a person confirms it; after a long
interruption the motion continues only on a resume request; every state ends in release, or in a hold that reports the
input it waits for.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields, replace
from itertools import compress, product
from operator import attrgetter
from typing import get_args

from kinesic.hardware.supervisor.observation import Observation
from kinesic.hardware.supervisor.state_machine import POWERED_STAGES, Action, Event, Stage, SupervisorState

Step = tuple[SupervisorState, tuple[Action, ...]]
Cube = tuple[int, int]  # bits of the variables that must have a value, and these values

ALL_EVENTS: frozenset[Event] = frozenset(get_args(Event))
ALL_STAGES = frozenset(Stage)
FLAG_NAMES = tuple(field.name for field in fields(SupervisorState) if field.name != "stage")
INPUT_NAMES = (*(field.name for field in fields(Observation) if field.name != "policy"), "limp_policy")
VARIABLE_NAMES = (*FLAG_NAMES, *INPUT_NAMES)  # conditions that are not combined from others
MOTIONLESS_STAGES = frozenset({Stage.LOST, Stage.IDENTIFY, Stage.ARM, Stage.ADOPT})  # torque changes, nothing moves

COMBINED_CONDITIONS: Mapping[str, tuple[tuple[str, ...], ...]] = {
    "over": (("ended",), ("release",), ("weak",), ("confirmed",)),
    "ending": (("over",), ("faulty",)),
    "dismissed": (("release",), ("confirmed",), ("alone",)),
    "torque_gone": (("not energised", "faulty"), ("not energised", "not limp")),
    "may_arm": (
        ("limp", "answering", "not refused", "not confirmed", "raised"),
        ("limp", "answering", "not refused", "not confirmed", "not paused", "not ending"),
    ),
    "may_fold": (
        ("idle",),
        ("not careful", "not paused"),
        ("not careful", "release"),
        ("not careful", "confirmed"),
    ),
    "may_release": (("not raised",), ("confirmed",)),
    "must_stop": (("ending",), ("paused",), ("not well",), ("not due",)),
}
"""Combined conditions: the alternatives of each, and the conditions that all hold in an alternative."""


@dataclass(frozen=True, eq=False)
class FlagRule:
    """Flags that change with an event or condition in any stage."""

    sets: Mapping[str, bool]
    events: frozenset[Event] = ALL_EVENTS
    when: tuple[str, ...] = ()  # conditions that all hold
    stages: frozenset[Stage] = ALL_STAGES


@dataclass(frozen=True, eq=False)
class Transition:
    """Row of the transition table."""

    stages: frozenset[Stage]
    to: Stage | None = None  # next stage; None: unchanged
    actions: tuple[Action, ...] = ()  # actions that begin
    events: frozenset[Event] = ALL_EVENTS
    when: tuple[str, ...] = ()  # conditions that all hold
    sets: Mapping[str, bool] | None = None  # flags that change


def _on(*events: Event) -> frozenset[Event]:
    return frozenset(events)


def _in(*stages: Stage) -> frozenset[Stage]:
    return frozenset(stages)


FLAG_RULES = (
    FlagRule({"faulty": True}, _on("failed")),
    FlagRule({"stopped": False, "paused": False}, _on("resumed")),
    FlagRule({"refused": False}, _on("mended", "resumed")),
    FlagRule({"paused": True}, when=("interrupted", "armed"), stages=POWERED_STAGES),
    FlagRule({"stopped": True, "paused": True}, _on("estop")),
)
"""Changes of flags, applied in this order before the transition."""

TRANSITION_TABLE = (
    # Emergency stop: hold, or switch torque off by its policy. Servos without torque get none unless a limb is raised.
    Transition(_in(Stage.CLOSED, Stage.RELEASE), events=_on("estop")),
    Transition(ALL_STAGES, Stage.CLOSED, ("close",), _on("estop"), ("not checked",)),
    Transition(ALL_STAGES, Stage.RELEASE, ("release",), _on("estop"), ("limp_policy",)),
    Transition(_in(Stage.ARM), Stage.RELEASE, ("release",), _on("estop"), ("not raised",)),
    Transition(MOTIONLESS_STAGES, events=_on("estop")),
    Transition(POWERED_STAGES, Stage.STOPPED, ("slow",), _on("estop")),
    Transition(ALL_STAGES, Stage.CLOSED, ("close",), _on("estop")),
    # Ports and bus watchdogs.
    Transition(POWERED_STAGES, Stage.LOST, ("slow",), _on("lost")),
    Transition(POWERED_STAGES - MOTIONLESS_STAGES, Stage.ADOPT, ("adopt",), _on("tripped")),
    # Start.
    Transition(_in(Stage.CLOSED), Stage.PROBE, ("check",), _on("open"), sets=dict.fromkeys(FLAG_NAMES, False)),
    Transition(_in(Stage.PROBE, Stage.CONFIGURE), Stage.CLOSED, ("close",), _on("refused")),
    Transition(_in(Stage.PROBE), Stage.CONFIGURE, ("configure",), _on("done"), sets={"checked": True}),
    Transition(_in(Stage.CONFIGURE), Stage.ADOPT, ("adopt",), _on("done"), ("energised",), {"powered": True}),
    Transition(_in(Stage.CONFIGURE), Stage.LIMP, events=_on("done")),
    Transition(_in(Stage.LIMP), Stage.CLOSED, ("close",), when=("ending",)),
    Transition(_in(Stage.LIMP), Stage.ARM, ("arm",), when=("begun", "answering"), sets={"powered": True}),
    Transition(_in(Stage.ARM), Stage.HOLD, ("hold",), _on("done"), sets={"armed": True}),
    Transition(
        _in(Stage.ARM),
        Stage.HOLD,
        ("hold",),
        _on("refused"),
        sets={"armed": True, "faulty": True, "refused": True},
    ),
    # Hold: torque that is gone or may come, then the end of the performance, then its beginning.
    Transition(_in(Stage.HOLD), Stage.RELEASE, ("release",), when=("torque_gone",)),
    Transition(_in(Stage.HOLD), Stage.STOPPED, ("hold",), when=("stopped", "not dismissed")),
    Transition(_in(Stage.HOLD), Stage.ARM, ("arm",), when=("may_arm",), sets={"folded": False}),
    Transition(_in(Stage.HOLD), Stage.FOLD, ("fold",), when=("ending", "not folded", "may_fold")),
    Transition(_in(Stage.HOLD), when=("ending", "not folded")),
    Transition(_in(Stage.HOLD), Stage.RELEASE, ("release",), when=("ending", "may_release")),
    Transition(_in(Stage.HOLD), Stage.WAITING, when=("ending", "idle")),
    Transition(_in(Stage.HOLD), when=("ending",)),  # the limb may still be settling
    Transition(
        _in(Stage.HOLD), Stage.APPROACH, ("approach",), when=("due", "well", "not paused"), sets={"folded": False}
    ),
    Transition(_in(Stage.HOLD), Stage.FOLD, ("fold",), when=("idle", "not folded")),
    # Performance.
    Transition(_in(Stage.APPROACH), Stage.DEGRADED, ("slow",), when=("must_stop",), sets={"approaching": True}),
    Transition(_in(Stage.APPROACH), Stage.ACTIVE, ("follow",), when=("reached",)),
    Transition(_in(Stage.ACTIVE), Stage.DEGRADED, ("slow",), when=("must_stop",), sets={"approaching": False}),
    Transition(_in(Stage.DEGRADED), Stage.HOLD, ("hold",), when=("still",)),
    Transition(_in(Stage.DEGRADED), when=("must_stop",)),
    Transition(_in(Stage.DEGRADED), Stage.APPROACH, when=("approaching",)),
    Transition(_in(Stage.DEGRADED), Stage.ACTIVE),
    # Rest and release. After a failure the move begins again, because the chain of the failed servo may have to hold.
    Transition(_in(Stage.FOLD), Stage.FOLD, ("fold",), _on("failed")),
    Transition(_in(Stage.FOLD), Stage.HOLD, ("hold",), when=("reached",), sets={"folded": True, "careful": False}),
    Transition(_in(Stage.WAITING), Stage.RELEASE, ("release",), when=("may_release",)),
    Transition(_in(Stage.WAITING), Stage.HOLD, ("hold",), _on("resumed"), sets={"folded": False}),
    Transition(_in(Stage.WAITING), Stage.HOLD, ("hold",), _on("mended"), sets={"folded": False, "careful": True}),
    Transition(_in(Stage.WAITING), Stage.HOLD, ("hold",), when=("may_arm",), sets={"folded": False, "careful": True}),
    Transition(_in(Stage.RELEASE), Stage.CLOSED, ("close",), _on("refused")),  # some servos may still have torque
    Transition(_in(Stage.RELEASE), Stage.CLOSED, ("close",), _on("done"), sets={"powered": False}),
    # After an emergency stop or a lost port.
    Transition(_in(Stage.STOPPED), Stage.HOLD, ("hold",), _on("resumed"), sets={"folded": False}),
    Transition(_in(Stage.STOPPED), Stage.HOLD, ("hold",), when=("dismissed",), sets={"folded": False}),
    Transition(_in(Stage.LOST), Stage.IDENTIFY, ("identify",), _on("back")),
    Transition(_in(Stage.LOST), Stage.CLOSED, ("close",), when=("hopeless",)),
    Transition(_in(Stage.IDENTIFY), Stage.ADOPT, ("adopt",), _on("done")),
    Transition(_in(Stage.IDENTIFY), Stage.LOST, ("slow",), _on("refused")),
    Transition(_in(Stage.ADOPT), Stage.HOLD, ("hold",), _on("done"), sets={"armed": True, "folded": False}),
    Transition(
        _in(Stage.ADOPT),
        Stage.HOLD,
        ("hold",),
        _on("refused"),
        sets={"armed": True, "faulty": True, "folded": False},
    ),
)
"""Transitions of the supervisor.

The first row with matching stage, event and conditions applies; without one, nothing changes.
"""


def step(state: SupervisorState, event: Event, observation: Observation) -> Step:
    """Return the supervisor's next state, and the actions that begin.

    Args:
        state: current state.
        event: event of this step.
        observation: further inputs.
    """
    values = _bits(state, observation)
    for rule, cubes in _FLAG_ROWS[state.stage, event]:
        if _matches(values, cubes):
            state = replace(state, stage=state.stage, **rule.sets)
            values = _bits(state, observation)
    for row, cubes in _TRANSITION_ROWS[state.stage, event]:
        if _matches(values, cubes):
            return replace(state, stage=row.to or state.stage, **(row.sets or {})), row.actions
    return state, ()


def expand(conditions: Iterable[str]) -> tuple[Cube, ...]:
    """Return the cubes of variable values in which all conditions hold."""
    cubes: list[Cube] = [(0, 0)]
    for condition in conditions:
        pairs = product(cubes, _alternatives(condition))
        cubes = [(a | b, x | y) for (a, x), (b, y) in pairs if not (x ^ y) & a & b]
    return tuple(cubes)


def _alternatives(condition: str) -> list[Cube]:
    """Return the cubes of one condition, which may be combined or negated."""
    name, is_negated = condition.removeprefix("not "), condition.startswith("not ")
    if name not in COMBINED_CONDITIONS:
        bit = 1 << VARIABLE_NAMES.index(name)
        return [(bit, 0 if is_negated else bit)]
    alternatives = COMBINED_CONDITIONS[name]
    if is_negated:  # of each alternative, one condition fails
        alternatives = tuple(tuple(map(_negated, failing)) for failing in product(*alternatives))
    return [cube for conditions in alternatives for cube in expand(conditions)]


def _negated(condition: str) -> str:
    return condition.removeprefix("not ") if condition.startswith("not ") else f"not {condition}"


def _bits(state: SupervisorState, observation: Observation) -> int:
    """Pack the variables of a state and an observation into an integer."""
    return sum(compress(_VARIABLE_BITS, (*_READ_FLAGS(state), *_READ_INPUTS(observation))))


def _matches(values: int, cubes: tuple[Cube, ...]) -> bool:
    return any(values & mask == required for mask, required in cubes)


_READ_FLAGS = attrgetter(*FLAG_NAMES)
_READ_INPUTS = attrgetter(*INPUT_NAMES)
_VARIABLE_BITS = tuple(1 << place for place in range(len(VARIABLE_NAMES)))
_STAGE_EVENTS = [(stage, event) for stage in Stage for event in sorted(ALL_EVENTS)]
_FLAG_ROWS = {
    (stage, event): [(rule, expand(rule.when)) for rule in FLAG_RULES if stage in rule.stages and event in rule.events]
    for stage, event in _STAGE_EVENTS
}
_TRANSITION_ROWS = {
    (stage, event): [(row, expand(row.when)) for row in TRANSITION_TABLE if stage in row.stages and event in row.events]
    for stage, event in _STAGE_EVENTS
}
