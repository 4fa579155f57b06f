"""The compiled loop does what Python does tick by tick."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.command import RATE, Command
from kinesic.controller import closed_loop
from kinesic.controller.closed_loop import perform_in_twins
from kinesic.controller.feedforward import FeedForward
from kinesic.controller.perform import dry_runs
from kinesic.sim.servo_factors import NOMINAL, PESSIMISTIC, Factors
from kinesic.sim.stepping import driven_motion, simulation
from kinesic.sim.stepping.addresses import _timestep_offset, function_address, timestep_address
from kinesic.sim.stepping.recorder import Recorder
from kinesic.sim.twin import STEP, Twin

LATE_AND_LOOSE = Factors(gain=0.7, latency=0.013, play=0.004)

pytestmark = pytest.mark.skipif(closed_loop.KERNEL != "compiled", reason="no compiled kernel")


@pytest.fixture
def in_python(monkeypatch):
    def run(*given, **options):
        with monkeypatch.context() as patch:
            patch.setattr(closed_loop, "KERNEL", "numpy")
            return dry_runs(*given, **options)

    return run


@pytest.fixture
def warm_motors(calm):
    """The robot with thermal figures for the servos of its elbows."""
    robot = calm.plan.setup.robot
    mounts = (
        replace(mount, drive=replace(mount.drive, servo=replace(mount.drive.servo, thermal=(5.0, 20.0))))
        if "elbow_flexion" in name
        else mount
        for name, mount in zip(robot.skeleton.names, robot.mounts, strict=True)
    )
    return replace(robot, mounts=tuple(mounts))


@pytest.mark.parametrize("correction", [True, False])
def test_compiled_and_tick_by_tick_it_is_the_same_motion(calm, in_python, correction):
    twins = (NOMINAL, PESSIMISTIC, LATE_AND_LOOSE)
    fast, slow = (run(calm.plan, twins, correction=correction, watch=False) for run in (dry_runs, in_python))
    for one, other in zip(fast, slow, strict=True):
        for name in ("times", "angles", "speeds", "torques", "duties", "goals"):
            np.testing.assert_allclose(
                getattr(one.measured, name), getattr(other.measured, name), rtol=0, atol=1e-9, err_msg=name
            )
        np.testing.assert_allclose(one.measured.clearance.distances, other.measured.clearance.distances, atol=1e-9)
        assert one.measured.power.energy == pytest.approx(other.measured.power.energy, abs=1e-9)


def test_a_twin_goes_on_from_where_the_loop_left_it(calm, in_python, monkeypatch):
    made: list[Twin] = []
    build = Twin.__init__

    def remember(self, *given, **options):
        build(self, *given, **options)
        made.append(self)

    monkeypatch.setattr(Twin, "__init__", remember)
    monkeypatch.setattr(simulation, "_shelf", lambda *given, **options: [])  # each keeps its own
    for run in (dry_runs, in_python):
        run(calm.plan, (LATE_AND_LOOSE,), watch=False)
    still = np.zeros_like(calm.reference.angles[0])
    end = float(calm.reference.times[-1])
    for twin in made:
        for k in range(1, 6):
            twin.write(Command(end + 0.01 * k, still, still, still, calm.reference.angles[0]))
    fast, slow = made
    assert fast.physics[1] is not slow.physics[1]
    np.testing.assert_allclose(fast.positions(), slow.positions(), rtol=0, atol=1e-9)
    assert np.ptp(fast.measurements().angles[-6:], axis=0).max() > 0.001


def test_progress_grows_over_all_twins(calm):
    shares: list[float] = []
    dry_runs(calm.plan, (NOMINAL, PESSIMISTIC), watch=False, progress=shares.append)
    assert shares == sorted(shares)
    assert shares[0] == 0.0
    assert 0.5 < shares[-1] < 1.0


def test_who_interrupts_is_heard(calm):
    def interrupt(share: float) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        dry_runs(calm.plan, (NOMINAL,), progress=interrupt)


def test_a_supply_that_sags_is_left_to_python(calm):
    robot = calm.plan.setup.robot
    assert Twin(robot).parts() is not None
    assert Twin(robot, factors=Factors(resistance=0.2)).parts() is None


def test_where_mujoco_is_not_as_expected_python_steps(calm, monkeypatch):
    model = Twin(calm.plan.setup.robot)._model
    assert function_address("mj_step")
    assert function_address("mj_stride") is None
    address = timestep_address(model)
    assert address == model._address + _timestep_offset()
    monkeypatch.setattr("kinesic.sim.twin.function_address", lambda name: None)
    assert Twin(calm.plan.setup.robot).parts() is None


@pytest.mark.parametrize("measuring", ["compiled", "numpy"])
def test_window_by_window_it_is_the_same_performance(calm, warm_motors, measuring, monkeypatch):
    monkeypatch.setattr(driven_motion, "KERNEL", measuring)
    plan = replace(calm.plan, setup=replace(calm.plan.setup, robot=warm_motors))
    twins = (NOMINAL, LATE_AND_LOOSE)
    whole = dry_runs(plan, twins, watch=False)
    monkeypatch.setattr(closed_loop, "COMMANDS_PER_WINDOW", 40)
    for one, other in zip(whole, dry_runs(plan, twins, watch=False), strict=True):
        assert np.array_equal(one.reference.duties, other.reference.duties)
        _assert_the_same(one.measured, other.measured)


def _assert_the_same(whole, parts):
    for name in ("times", "angles", "speeds", "torques", "duties", "goals"):
        assert np.array_equal(getattr(whole, name), getattr(parts, name)), name
    assert all(np.array_equal(whole.hands[side], parts.hands[side]) for side in "lr")
    assert whole.clearance.distances.min() == parts.clearance.distances.min()
    assert (parts.clearance.distances <= whole.clearance.distances).all(), "until the least is known, more is measured"
    assert np.array_equal(whole.power.mean, parts.power.mean)
    assert np.array_equal(whole.power.peak, parts.power.peak)
    assert parts.power.energy == pytest.approx(whole.power.energy, rel=1e-13)
    assert parts.power.volts == whole.power.volts
    rises = whole.power.warming["l_elbow_flexion"]
    assert rises.max() > 0.01
    np.testing.assert_allclose(parts.power.warming["l_elbow_flexion"], rises, rtol=1e-13)


def test_no_more_than_a_window_of_steps_is_kept(calm, monkeypatch):
    kept = []
    add = Recorder.add
    monkeypatch.setattr(Recorder, "add", lambda self, log: kept.append(len(log.kept().spans)) or add(self, log))
    monkeypatch.setattr(closed_loop, "COMMANDS_PER_WINDOW", 40)
    dry_runs(calm.plan, (NOMINAL, PESSIMISTIC), watch=False)
    assert len(kept) == 2 * -(-len(calm.reference.times) // 40)
    assert max(kept) <= 1 + 40 * np.ceil(1 / RATE / STEP)


@pytest.fixture
def perform(calm):
    """Performs commands at some times in a twin that was just built, and gives this twin."""
    known, trajectory = calm.plan.setup, calm.plan.trajectory
    leading = FeedForward(known.robot, known.dynamics)

    def run(times):
        twin = Twin(known.robot, start=trajectory.at(0.0).angles)
        for _ in perform_in_twins(
            trajectory, times, lambda part: leading.lead(trajectory, part), [twin], None, lambda share: None
        ):
            pass
        return twin

    return run


def test_who_looks_only_at_the_end_sees_the_same(calm, perform, monkeypatch):
    whole = perform(calm.reference.times).measurements()
    monkeypatch.setattr(closed_loop, "COMMANDS_PER_WINDOW", 64)
    parts = perform(calm.reference.times).measurements()
    for name in ("times", "angles", "speeds", "torques", "duties", "goals"):
        assert np.array_equal(getattr(whole, name), getattr(parts, name)), name


def test_one_command_is_a_performance(calm, perform):
    assert perform(calm.reference.times[:1]).measurements().angles.shape == (1, len(calm.plan.trajectory.controls[0]))


@pytest.mark.parametrize("times", [[0.0, 0.01, 0.0], [0.0, float("nan")], [0.0, float("inf")]])
def test_times_that_do_not_go_on_are_refused(perform, times):
    with pytest.raises(ValueError, match="finite and not decrease"):
        perform(np.array(times))


def test_a_recorder_is_filled_once_and_wholly(calm):
    twin, still = Twin(calm.plan.setup.robot), [np.zeros_like(calm.reference.angles[0])] * 4
    recorder = twin.recorder(2)
    with pytest.raises(ValueError, match="no command was written"):
        twin.record(recorder)
    twin.write(Command(0.0, *still))
    twin.record(recorder)
    with pytest.raises(ValueError, match="1 of 2 commands"):
        recorder.measurements()
    twin.write(Command(0.01, *still))
    twin.write(Command(0.02, *still))
    with pytest.raises(ValueError, match="room for 2"):
        twin.record(recorder)
