"""The page of the supervisor's state machine, written from its transition table."""

import inspect
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import get_args

from struct_tables import read_comments

from kinesic.hardware.supervisor import state_machine
from kinesic.hardware.supervisor.observation import Observation
from kinesic.hardware.supervisor.state_machine import POWERED_STAGES, Action, Event, Stage, SupervisorState
from kinesic.hardware.supervisor.transitions import (
    ALL_EVENTS,
    ALL_STAGES,
    COMBINED_CONDITIONS,
    FLAG_NAMES,
    FLAG_RULES,
    INPUT_NAMES,
    TRANSITION_TABLE,
    FlagRule,
    Transition,
)

HEAD = """# State machine of the supervisor

The [supervisor](../explanation/servos.md#the-supervisor) drives the servos. This page lists exactly what the supervisor
does in each situation, for example when it switches torque off.

In each cycle, the supervisor selects one row of the [transition table](#transitions). The row depends on three things:
the current *stage*, the *event* of this cycle, and *conditions*. A condition is an input (an observation of the servos
or of the planner), a flag (which the supervisor remembers), or a combination of these. The row names the next stage,
the actions that begin, and the flags that change.

The tables use these words: the *manifest* lists the servos that the robot's file describes. A *goal* is the position
that a servo should take. A *limp* servo has no torque. A *raised* limb may be away from the rest posture, so it could
fall. An *interruption* is a period in which the arms could not follow the performance.

The page is generated from `kinesic/hardware/supervisor/transitions.py`, which the supervisor executes. A test checks
[every reachable state with every event and every
observation](../benchmarks/proof.md#state-machine-of-the-supervisor).
"""
FLAG_RULE_TEXT = "An event can change flags before a transition is chosen. The rules apply from top to bottom:"
TRANSITION_TEXT = (
    "After the flags have changed, the supervisor searches this table from top to bottom. It executes the first row "
    "whose stage, event and conditions match. If no row matches, nothing changes."
)
SETS = {ALL_STAGES: "any", POWERED_STAGES: "any with torque"}  # names of sets of stages


def write_page() -> str:
    """Return the page with stages, events, inputs, flags, actions and transitions."""
    inputs = read_comments(Observation) | {"limp_policy": "an emergency stop switches torque off"}
    flags = read_comments(SupervisorState)
    lines = [HEAD, "## Stages", "", "| stage | meaning | torque |", "|---|---|---|"]
    meanings = _comments("class Stage", (stage.value for stage in Stage))
    lines += [
        f"| {stage.value} | {meanings[stage.value]} | {'possible' if stage in POWERED_STAGES else ''} |"
        for stage in Stage
    ]
    lines += _meaning_table("Events", "event", _comments("Event =", get_args(Event)))
    lines += _meaning_table("Inputs", "input", {name: inputs[name] for name in INPUT_NAMES})
    lines += _meaning_table("Flags", "flag", {name: flags[name] for name in FLAG_NAMES})
    lines += _meaning_table("Actions", "action", _comments("Action =", get_args(Action)))
    lines += ["", "## Combined conditions", "", "| condition | holds if |", "|---|---|"]
    lines += [f"| {name} | {_any_of(parts)} |" for name, parts in COMBINED_CONDITIONS.items()]
    lines += ["", "## Changes of flags", "", FLAG_RULE_TEXT, ""]
    lines += ["| stage | event | if | flags |", "|---|---|---|---|"]
    lines += [
        f"| {_stages(rule)} | {_events(rule)} | {_all_of(rule.when)} | {_flags(rule.sets)} |" for rule in FLAG_RULES
    ]
    lines += ["", "## Transitions", ""]
    lines += [TRANSITION_TEXT, ""]
    lines += ["| stage | event | if | next stage | actions | flags |", "|---|---|---|---|---|---|"]
    lines += map(_transition, TRANSITION_TABLE)
    return "\n".join(lines) + "\n"


def _comments(definition: str, names: Iterable[str]) -> dict[str, str]:
    """Return the comment of each name in the source of `state_machine`.

    Only the source after `definition` is searched.
    """
    source = inspect.getsource(state_machine).partition(definition)[2]
    return {name: re.findall(rf'"{name}",?  # (.+)', source)[0] for name in names}


def _meaning_table(title: str, kind: str, meanings: Mapping[str, str]) -> list[str]:
    rows = [f"| {name} | {meaning} |" for name, meaning in meanings.items()]
    return ["", f"## {title}", "", f"| {kind} | meaning |", "|---|---|", *rows]


def _transition(row: Transition) -> str:
    following = "unchanged" if row.to is None else row.to.value
    cells = (_stages(row), _events(row), _all_of(row.when), following, ", ".join(row.actions), _flags(row.sets or {}))
    return f"| {' | '.join(cells)} |"


def _stages(row: FlagRule | Transition) -> str:
    return SETS.get(row.stages) or ", ".join(stage.value for stage in Stage if stage in row.stages)


def _events(row: FlagRule | Transition) -> str:
    return "any" if row.events == ALL_EVENTS else ", ".join(sorted(row.events))


def _all_of(conditions: Sequence[str]) -> str:
    return " and ".join(conditions)


def _any_of(alternatives: Sequence[Sequence[str]]) -> str:
    return " or ".join(f"({_all_of(parts)})" if len(parts) > 1 else parts[0] for parts in alternatives)


def _flags(changes: Mapping[str, bool]) -> str:
    if set(changes) == set(FLAG_NAMES) and not any(changes.values()):
        return "all off"
    return ", ".join(f"{name} {'on' if value else 'off'}" for name, value in changes.items())
