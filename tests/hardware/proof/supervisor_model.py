"""Finite model of the supervisor with all reachable states.

Every event and every observation is applied to each state. The model is built from the transition table. The set of
observations for which a row applies is a truth table: an integer with one bit per combination of the inputs. Besides
the supervisor's flags, the model keeps memory of its own, so that a lost flag shows as a broken rule.
"""

from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache

from kinesic.hardware.supervisor.state_machine import POWERED_STAGES, Action, Event, Stage, SupervisorState
from kinesic.hardware.supervisor.transitions import (
    ALL_EVENTS,
    FLAG_NAMES,
    FLAG_RULES,
    INPUT_NAMES,
    TRANSITION_TABLE,
    VARIABLE_NAMES,
    Cube,
    FlagRule,
    Transition,
    expand,
)

MOTION_ACTIONS = {"approach", "follow", "fold"}  # actions that move the robot
PERFORMING_STAGES = {Stage.APPROACH, Stage.ACTIVE}  # stages that move towards or along the performance
INPUTS_OF_RULES = {"raised", "energised", "confirmed", "release", "alone", "limp_policy", "interrupted"}
STOP_STAGES = {Stage.STOPPED, Stage.RELEASE, Stage.CLOSED, Stage.LOST, Stage.IDENTIFY, Stage.ARM, Stage.ADOPT}


Outcome = tuple[tuple[str, ...], int, SupervisorState, tuple[Action, ...]]  # inputs, truth table, next state, actions


@dataclass(frozen=True)
class Memory:
    """Past events that matter for the rules, independent of the supervisor's flags."""

    had_torque: bool = False  # all servos have had torque since the ports were opened
    needs_consent: bool = False  # an interruption or stop came after the last resume request
    is_stopped: bool = False  # an emergency stop came after the last resume request or dismissal
    has_failed: bool = False  # a servo has failed since the ports were opened


@dataclass(frozen=True)
class Node:
    """State of the model."""

    state: SupervisorState
    memory: Memory


@dataclass(frozen=True)
class Case:
    """Transition of the model, with the observations that lead to it."""

    before: Node
    event: Event
    inputs: tuple[str, ...]  # inputs that the truth table covers
    table: int  # truth table of the observations
    after: Node
    actions: tuple[Action, ...]

    def when(self, name: str) -> int:
        """Return the truth table of one input."""
        return variable_table(self.inputs.index(name), len(self.inputs))


@cache
def variable_table(place: int, count: int) -> int:
    """Return the truth table of one of several inputs."""
    width = 1 << place
    return all_ones(count) // ((1 << width) + 1) << width


@cache
def all_ones(count: int) -> int:
    """Return the truth table that is true for all `count` observations."""
    return (1 << (1 << count)) - 1


class SupervisorModel:
    """Model of a transition table."""

    def __init__(
        self, transitions: Sequence[Transition] = TRANSITION_TABLE, rules: Sequence[FlagRule] = FLAG_RULES
    ) -> None:
        self._rows = [(row, expand(row.when)) for row in transitions]
        self._rules = [(rule, expand(rule.when)) for rule in rules]
        self._known: dict[tuple[SupervisorState, tuple[int, ...]], list[Outcome]] = {}

    def explore(self) -> Iterator[Case]:
        """Yield every transition between reachable states, near ones first."""
        first = Node(SupervisorState(), Memory())
        seen, left = {first}, deque([first])
        while left:
            node = left.popleft()
            for event in sorted(ALL_EVENTS):
                for case in self._cases(node, event):
                    yield case
                    if case.after not in seen:
                        seen.add(case.after)
                        left.append(case.after)

    def _cases(self, node: Node, event: Event) -> Iterator[Case]:
        for inputs, table, after, actions in self._outcomes(node.state, event):
            yield from _remembered(Case(node, event, inputs, table, replace(node, state=after), actions))

    def _outcomes(self, state: SupervisorState, event: Event) -> list[Outcome]:
        """Return the outcomes of an event.

        They are the same for all events with the same rows.
        """
        rules = [pair for pair in self._rules if state.stage in pair[0].stages and event in pair[0].events]
        rows = [pair for pair in self._rows if state.stage in pair[0].stages and event in pair[0].events]
        key = state, tuple(id(pair) for pair in (*rules, *rows))
        if key not in self._known:
            self._known[key] = list(_outcomes(state, rules, rows))
        return self._known[key]


def _outcomes(
    start: SupervisorState,
    rules: Sequence[tuple[FlagRule, tuple[Cube, ...]]],
    rows: Sequence[tuple[Transition, tuple[Cube, ...]]],
) -> Iterator[Outcome]:
    read = {name for _, cubes in (*rules, *rows) for cube in cubes for name in names_of(cube)}
    inputs = tuple(name for name in INPUT_NAMES if name in read | INPUTS_OF_RULES)
    tables = {name: variable_table(place, len(inputs)) for place, name in enumerate(inputs)}
    ones = all_ones(len(inputs))
    branches = [(start, ones & (ones ^ tables["raised"] | tables["energised"]))]
    for rule, cubes in rules:
        changed = []
        for state, table in branches:
            holds = table & holding(cubes, state, tables, ones)
            changed += [(replace(state, **rule.sets), holds), (state, table & ~holds)]
        branches = [(state, table) for state, table in changed if table]
    for state, table in branches:
        left = table
        for row, cubes in rows:
            if holds := left & holding(cubes, state, tables, ones):
                yield inputs, holds, replace(state, **(row.sets or {}), stage=row.to or state.stage), row.actions
                left &= ~holds
        if left:
            yield inputs, left, state, ()


def names_of(cube: Cube) -> list[str]:
    """Return the variables that a cube reads."""
    return [name for place, name in enumerate(VARIABLE_NAMES) if cube[0] >> place & 1]


def holding(cubes: Sequence[Cube], state: SupervisorState, tables: dict[str, int], ones: int) -> int:
    """Return the truth table of observations that satisfy any cube."""
    total = 0
    for mask, values in cubes:
        table = ones
        for place, name in enumerate(VARIABLE_NAMES):
            if mask >> place & 1:
                is_true = bool(values >> place & 1)
                if name in FLAG_NAMES:
                    table = table if getattr(state, name) is is_true else 0
                else:
                    table &= tables[name] if is_true else ones ^ tables[name]
        total |= table
    return total


def _remembered(case: Case) -> Iterator[Case]:
    """Yield a transition once for each change of the model's memory."""
    dismissed = case.when("release") | case.when("confirmed") | case.when("alone")
    for is_interrupted, first in split(case.table, case.when("interrupted")):
        for is_dismissed, second in split(first, dismissed):
            memory = _next_memory(case, is_interrupted=is_interrupted, is_dismissed=is_dismissed)
            yield replace(case, table=second, after=replace(case.after, memory=memory))


def split(table: int, condition: int) -> list[tuple[bool, int]]:
    """Split a truth table by a condition into its nonempty parts."""
    parts = [(True, table & condition), (False, table & ~condition)]
    return [(holds, part) for holds, part in parts if part]


def _next_memory(case: Case, *, is_interrupted: bool, is_dismissed: bool) -> Memory:
    memory, before, event = case.before.memory, case.before.state.stage, case.event
    if before is Stage.CLOSED:
        return Memory() if event == "open" else memory
    if event == "resumed":
        memory = replace(memory, needs_consent=False, is_stopped=False)
    if is_dismissed:
        memory = replace(memory, is_stopped=False)
    if event == "estop":
        memory = replace(memory, needs_consent=True, is_stopped=not is_dismissed)
    if event == "failed" or (event == "refused" and before in (Stage.ARM, Stage.ADOPT)):
        memory = replace(memory, has_failed=True)
    if is_interrupted and memory.had_torque and before in POWERED_STAGES:
        memory = replace(memory, needs_consent=True)
    has_torque = memory.had_torque or (before in (Stage.ARM, Stage.ADOPT) and case.after.state.stage is Stage.HOLD)
    return replace(memory, had_torque=has_torque)


def nodes_without_end(cases: Sequence[Case]) -> set[Node]:
    """Return the reachable states from which the ports cannot be closed."""
    sources: dict[Node, set[Node]] = {}
    for case in cases:
        sources.setdefault(case.after, set()).add(case.before)
    ending = {node for node in sources if node.state.stage is Stage.CLOSED}
    left = list(ending)
    while left:
        for source in sources.get(left.pop(), set()) - ending:
            ending.add(source)
            left.append(source)
    return {case.before for case in cases} - ending


def broken_rules(case: Case) -> Iterator[str]:
    """Yield the safety rules that a transition breaks."""
    actions, memory, after = set(case.actions), case.after.memory, case.after.state
    permitted = case.when("confirmed") | (case.when("limp_policy") if case.event == "estop" else 0)
    if "release" in actions and case.table & case.when("raised") & ~permitted:
        yield "raised limbs keep their torque"
    if memory.needs_consent and (after.stage in PERFORMING_STAGES or actions & {"approach", "follow"}):
        yield "motion continues only on request"
    if memory.needs_consent and "arm" in actions and case.table & ~case.when("raised"):
        yield "torque returns only on request"
    if case.event == "estop" and (after.stage not in STOP_STAGES or actions & (MOTION_ACTIONS | {"arm", "adopt"})):
        yield "stop is reachable from every state"
    if memory.is_stopped and (after.stage in PERFORMING_STAGES | {Stage.FOLD} or actions & MOTION_ACTIONS):
        yield "nothing moves after a stop"
    if memory.has_failed and actions & {"approach", "follow"}:
        yield "no performance after a failure"
    if actions & {"arm", "adopt"} and not case.before.state.checked:
        yield "torque only after the check"
