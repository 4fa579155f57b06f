from dataclasses import replace

import pytest

from kinesic.hardware.supervisor.observation import Observation
from kinesic.hardware.supervisor.state_machine import Stage, SupervisorState
from kinesic.hardware.supervisor.transitions import step

HEALTHY_OBSERVATION = Observation(energised=True)  # all servos have torque and no fault


def at(stage: Stage, **changes: bool) -> SupervisorState:
    return replace(SupervisorState(stage, checked=True, powered=True), **changes)


def test_supervisor_stages_go_from_closed_to_performance_and_back():
    state, actions = step(SupervisorState(), "open", Observation())
    assert (state.stage, actions) == (Stage.PROBE, ("check",))
    state, actions = step(state, "done", Observation())
    assert (state.stage, actions) == (Stage.CONFIGURE, ("configure",))
    state, actions = step(state, "done", Observation())
    assert (state.stage, actions) == (Stage.LIMP, ())
    assert step(state, "tick", Observation())[0] == state
    state, actions = step(state, "tick", Observation(begun=True))
    assert (state.stage, actions) == (Stage.ARM, ("arm",))
    state, actions = step(state, "done", HEALTHY_OBSERVATION)
    assert state.stage is Stage.HOLD
    state, actions = step(state, "tick", replace(HEALTHY_OBSERVATION, due=True))
    assert (state.stage, actions) == (Stage.APPROACH, ("approach",))
    state, actions = step(state, "tick", replace(HEALTHY_OBSERVATION, due=True, reached=True))
    assert (state.stage, actions) == (Stage.ACTIVE, ("follow",))
    state, actions = step(state, "tick", replace(HEALTHY_OBSERVATION, ended=True))
    assert (state.stage, actions) == (Stage.DEGRADED, ("slow",))
    state, actions = step(state, "tick", replace(HEALTHY_OBSERVATION, ended=True, still=True))
    assert (state.stage, actions) == (Stage.HOLD, ("hold",))
    state, actions = step(state, "tick", replace(HEALTHY_OBSERVATION, ended=True))
    assert (state.stage, actions) == (Stage.FOLD, ("fold",))
    state, actions = step(state, "tick", replace(HEALTHY_OBSERVATION, ended=True, reached=True))
    assert (state.stage, state.folded) == (Stage.HOLD, True)
    state, actions = step(state, "tick", replace(HEALTHY_OBSERVATION, ended=True))
    assert (state.stage, actions) == (Stage.RELEASE, ("release",))
    state, actions = step(state, "done", Observation())
    assert (state.stage, actions, state.powered) == (Stage.CLOSED, ("close",), False)


@pytest.mark.parametrize("stage", [Stage.PROBE, Stage.CONFIGURE])
def test_ports_are_closed_at_once_if_their_servos_are_refused(stage: Stage):
    state, actions = step(SupervisorState(stage), "refused", Observation())
    assert (state.stage, actions) == (Stage.CLOSED, ("close",))


def test_servos_that_have_torque_are_taken_over_without_switching_torque_on():
    state, actions = step(SupervisorState(Stage.CONFIGURE, checked=True), "done", HEALTHY_OBSERVATION)
    assert (state.stage, actions) == (Stage.ADOPT, ("adopt",))
    assert step(state, "done", HEALTHY_OBSERVATION)[0].stage is Stage.HOLD


def test_performance_slowed_by_a_servo_fault_continues_if_it_recovers_before_standstill():
    state, _ = step(at(Stage.ACTIVE), "tick", replace(HEALTHY_OBSERVATION, due=True, well=False))
    assert state.stage is Stage.DEGRADED
    assert step(state, "tick", replace(HEALTHY_OBSERVATION, due=True, well=True, still=False))[0].stage is Stage.ACTIVE
    assert step(state, "tick", replace(HEALTHY_OBSERVATION, due=True, well=False, still=True))[0].stage is Stage.HOLD


def test_servo_that_has_lost_its_torque_gets_torque_again():
    state, actions = step(at(Stage.HOLD), "tick", replace(HEALTHY_OBSERVATION, limp=True, well=False))
    assert (state.stage, actions) == (Stage.ARM, ("arm",))


def test_failed_servo_slows_the_performance_to_a_stop_then_the_robot_moves_to_rest_and_releases_torque():
    state, _ = step(at(Stage.ACTIVE), "failed", replace(HEALTHY_OBSERVATION, due=True))
    assert state.faulty
    assert state.stage is Stage.DEGRADED
    state, actions = step(at(Stage.HOLD, faulty=True), "tick", replace(HEALTHY_OBSERVATION, due=True))
    assert actions == ("fold",)
    state, actions = step(at(Stage.HOLD, faulty=True, folded=True), "tick", replace(HEALTHY_OBSERVATION, due=True))
    assert actions == ("release",)


def test_robot_moves_to_rest_after_a_long_hold_and_keeps_torque():
    state, actions = step(at(Stage.HOLD), "tick", replace(HEALTHY_OBSERVATION, idle=True))
    assert actions == ("fold",)
    state, _ = step(state, "tick", replace(HEALTHY_OBSERVATION, reached=True))
    assert step(state, "tick", replace(HEALTHY_OBSERVATION, idle=True)) == (state, ())
    assert step(state, "tick", replace(HEALTHY_OBSERVATION, idle=True, due=True))[0].stage is Stage.APPROACH


def test_servos_of_a_reopened_port_are_adopted_and_a_port_lost_for_too_long_is_given_up():
    state, actions = step(at(Stage.ACTIVE), "lost", HEALTHY_OBSERVATION)
    assert (state.stage, actions) == (Stage.LOST, ("slow",))
    assert step(state, "back", HEALTHY_OBSERVATION)[1] == ("identify",)
    assert step(step(state, "back", HEALTHY_OBSERVATION)[0], "done", HEALTHY_OBSERVATION)[1] == ("adopt",)
    assert step(step(state, "back", HEALTHY_OBSERVATION)[0], "refused", HEALTHY_OBSERVATION)[0].stage is Stage.LOST
    assert step(state, "tick", replace(HEALTHY_OBSERVATION, hopeless=True))[0].stage is Stage.CLOSED


def test_emergency_stop_holds_or_releases_torque_by_policy():
    assert step(at(Stage.ACTIVE), "estop", HEALTHY_OBSERVATION)[0].stage is Stage.STOPPED
    assert step(at(Stage.ACTIVE), "estop", replace(HEALTHY_OBSERVATION, policy="limp"))[1] == ("release",)
    stopped = step(at(Stage.ACTIVE), "estop", HEALTHY_OBSERVATION)[0]
    assert step(stopped, "tick", replace(HEALTHY_OBSERVATION, due=True))[0] == stopped
    state, _ = step(stopped, "tick", replace(HEALTHY_OBSERVATION, release=True, raised=True))
    assert step(state, "tick", replace(HEALTHY_OBSERVATION, release=True, raised=True))[1] == ("fold",)


def test_emergency_stop_persists_after_a_port_loss():
    state, _ = step(at(Stage.LOST), "estop", HEALTHY_OBSERVATION)
    for event in ("back", "done", "done", "tick"):
        state, _ = step(state, event, HEALTHY_OBSERVATION)
    assert state.stage is Stage.STOPPED


RAISED_OBSERVATION = replace(HEALTHY_OBSERVATION, raised=True, ended=True)  # commands have ended, limb raised


def test_raised_limb_is_held_until_it_is_lowered_or_the_user_confirms():
    state = at(Stage.HOLD, folded=True, faulty=True)
    assert step(state, "tick", RAISED_OBSERVATION) == (state, ())
    state, actions = step(state, "tick", replace(RAISED_OBSERVATION, idle=True))
    assert (state.stage, actions) == (Stage.WAITING, ())
    assert step(state, "tick", RAISED_OBSERVATION) == (state, ())
    assert step(state, "tick", replace(RAISED_OBSERVATION, confirmed=True))[1] == ("release",)
    assert step(state, "tick", replace(RAISED_OBSERVATION, raised=False))[1] == ("release",)


def test_recovered_servo_gets_torque_again_and_moves_to_rest_when_idle():
    mended = replace(RAISED_OBSERVATION, limp=True)
    state, _ = step(at(Stage.WAITING, folded=True, faulty=True), "mended", mended)
    state, actions = step(state, "tick", mended)
    assert actions == ("arm",)
    state, _ = step(state, "done", RAISED_OBSERVATION)
    assert step(state, "tick", RAISED_OBSERVATION) == (state, ())
    assert step(state, "tick", replace(RAISED_OBSERVATION, idle=True))[1] == ("fold",)


def test_supervisor_does_not_retry_torque_that_could_not_be_switched_on():
    state, _ = step(at(Stage.ARM), "refused", replace(RAISED_OBSERVATION, limp=True))
    assert step(state, "tick", replace(RAISED_OBSERVATION, limp=True))[1] == ("fold",)
    assert step(replace(state, stage=Stage.WAITING), "tick", replace(RAISED_OBSERVATION, limp=True))[1] == ()


def test_performance_needs_a_resume_request_after_a_long_interruption():
    going = replace(HEALTHY_OBSERVATION, due=True)
    state, _ = step(at(Stage.ACTIVE, armed=True), "tick", replace(going, interrupted=True))
    assert (state.stage, state.paused) == (Stage.DEGRADED, True)
    state, _ = step(state, "tick", going)
    assert state.stage is Stage.HOLD
    assert step(state, "tick", going) == (state, ())
    assert step(state, "tick", replace(going, idle=True))[1] == ("fold",)
    assert step(state, "tick", replace(HEALTHY_OBSERVATION, limp=True)) == (state, ())
    assert step(state, "tick", replace(HEALTHY_OBSERVATION, limp=True, raised=True))[1] == ("arm",)
    state, _ = step(state, "resumed", going)
    assert state.stage is Stage.APPROACH


def test_resume_request_during_an_interruption_does_not_end_the_pause():
    state, _ = step(
        at(Stage.HOLD, armed=True, paused=True), "resumed", replace(HEALTHY_OBSERVATION, interrupted=True, due=True)
    )
    assert state.paused


def test_weak_supply_makes_the_robot_move_to_rest_and_then_disables_torque():
    state, actions = step(at(Stage.ACTIVE), "tick", replace(HEALTHY_OBSERVATION, due=True, weak=True, raised=True))
    assert actions == ("slow",)
    assert not state.faulty
    state, _ = step(state, "tick", replace(HEALTHY_OBSERVATION, weak=True, raised=True))
    assert step(state, "tick", replace(HEALTHY_OBSERVATION, weak=True, raised=True))[1] == ("fold",)
