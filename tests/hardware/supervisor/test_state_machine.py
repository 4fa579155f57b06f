from dataclasses import replace

import pytest

from kinesic.hardware.supervisor.state_machine import Observation, Stage, SupervisorState, step

CALM = Observation(energised=True)


def at(stage: Stage, **changes: bool) -> SupervisorState:
    return replace(SupervisorState(stage, checked=True, powered=True), **changes)


def test_the_way_from_closed_to_a_performance_and_back():
    state, actions = step(SupervisorState(), "open", Observation())
    assert (state.stage, actions) == (Stage.PROBE, ("check",))
    state, actions = step(state, "done", Observation())
    assert (state.stage, actions) == (Stage.CONFIGURE, ("configure",))
    state, actions = step(state, "done", Observation())
    assert (state.stage, actions) == (Stage.LIMP, ())
    assert step(state, "tick", Observation())[0] == state
    state, actions = step(state, "tick", Observation(begun=True))
    assert (state.stage, actions) == (Stage.ARM, ("arm",))
    state, actions = step(state, "done", CALM)
    assert state.stage is Stage.HOLD
    state, actions = step(state, "tick", replace(CALM, due=True))
    assert (state.stage, actions) == (Stage.APPROACH, ("approach",))
    state, actions = step(state, "tick", replace(CALM, due=True, reached=True))
    assert (state.stage, actions) == (Stage.ACTIVE, ("follow",))
    state, actions = step(state, "tick", replace(CALM, ended=True))
    assert (state.stage, actions) == (Stage.DEGRADED, ("slow",))
    state, actions = step(state, "tick", replace(CALM, ended=True, still=True))
    assert (state.stage, actions) == (Stage.HOLD, ("hold",))
    state, actions = step(state, "tick", replace(CALM, ended=True))
    assert (state.stage, actions) == (Stage.FOLD, ("fold",))
    state, actions = step(state, "tick", replace(CALM, ended=True, reached=True))
    assert (state.stage, state.folded) == (Stage.HOLD, True)
    state, actions = step(state, "tick", replace(CALM, ended=True))
    assert (state.stage, actions) == (Stage.RELEASE, ("release",))
    state, actions = step(state, "done", Observation())
    assert (state.stage, actions, state.powered) == (Stage.CLOSED, ("close",), False)


@pytest.mark.parametrize("stage", [Stage.PROBE, Stage.CONFIGURE])
def test_wrong_servos_are_closed_at_once(stage: Stage):
    state, actions = step(SupervisorState(stage), "refused", Observation())
    assert (state.stage, actions) == (Stage.CLOSED, ("close",))


def test_servos_that_have_torque_are_adopted_and_not_armed():
    state, actions = step(SupervisorState(Stage.CONFIGURE, checked=True), "done", CALM)
    assert (state.stage, actions) == (Stage.ADOPT, ("adopt",))
    assert step(state, "done", CALM)[0].stage is Stage.HOLD


def test_a_short_weakness_only_slows_the_performance():
    state, _ = step(at(Stage.ACTIVE), "tick", replace(CALM, due=True, well=False))
    assert state.stage is Stage.DEGRADED
    assert step(state, "tick", replace(CALM, due=True, well=True, still=False))[0].stage is Stage.ACTIVE
    assert step(state, "tick", replace(CALM, due=True, well=False, still=True))[0].stage is Stage.HOLD


def test_a_servo_that_has_lost_its_torque_is_armed_again():
    state, actions = step(at(Stage.HOLD), "tick", replace(CALM, limp=True, well=False))
    assert (state.stage, actions) == (Stage.ARM, ("arm",))


def test_a_failure_ends_the_performance():
    state, _ = step(at(Stage.ACTIVE), "failed", replace(CALM, due=True))
    assert state.faulty
    assert state.stage is Stage.DEGRADED
    state, actions = step(at(Stage.HOLD, faulty=True), "tick", replace(CALM, due=True))
    assert actions == ("fold",)
    state, actions = step(at(Stage.HOLD, faulty=True, folded=True), "tick", replace(CALM, due=True))
    assert actions == ("release",)


def test_holding_for_long_ends_at_rest_with_torque():
    state, actions = step(at(Stage.HOLD), "tick", replace(CALM, idle=True))
    assert actions == ("fold",)
    state, _ = step(state, "tick", replace(CALM, reached=True))
    assert step(state, "tick", replace(CALM, idle=True)) == (state, ())
    assert step(state, "tick", replace(CALM, idle=True, due=True))[0].stage is Stage.APPROACH


def test_a_port_that_comes_back_is_adopted_and_one_that_does_not_is_given_up():
    state, actions = step(at(Stage.ACTIVE), "lost", CALM)
    assert (state.stage, actions) == (Stage.LOST, ("slow",))
    assert step(state, "back", CALM)[1] == ("adopt",)
    assert step(state, "tick", replace(CALM, hopeless=True))[0].stage is Stage.CLOSED


def test_an_emergency_stop_holds_or_lets_go_by_policy():
    assert step(at(Stage.ACTIVE), "estop", CALM)[0].stage is Stage.STOPPED
    assert step(at(Stage.ACTIVE), "estop", replace(CALM, policy="limp"))[1] == ("release",)
    stopped = step(at(Stage.ACTIVE), "estop", CALM)[0]
    assert step(stopped, "tick", replace(CALM, due=True))[0] == stopped
    assert step(stopped, "tick", replace(CALM, release=True))[1] == ("release",)


def test_an_emergency_stop_outlives_a_lost_port():
    state, _ = step(at(Stage.LOST), "estop", CALM)
    state, _ = step(state, "back", CALM)
    assert step(state, "done", CALM)[0].stage is Stage.STOPPED
