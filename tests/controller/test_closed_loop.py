"""The compiled loop does what Python does tick by tick."""

from weakref import ref

import numpy as np
import pytest

from kinesic.body.command import Command
from kinesic.controller import closed_loop
from kinesic.controller.perform import dry_runs
from kinesic.sim.servo_factors import NOMINAL, PESSIMISTIC, Factors
from kinesic.sim.stepping.addresses import _timestep_offset, function_address, timestep_address
from kinesic.sim.twin import Twin

LATE_AND_LOOSE = Factors(gain=0.7, latency=0.013, play=0.004)

pytestmark = pytest.mark.skipif(closed_loop.KERNEL != "compiled", reason="no compiled kernel")


@pytest.fixture
def in_python(monkeypatch):
    def run(*given, **options):
        with monkeypatch.context() as patch:
            patch.setattr(closed_loop, "KERNEL", "numpy")
            return dry_runs(*given, **options)

    return run


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
    for run in (dry_runs, in_python):
        run(calm.plan, (LATE_AND_LOOSE,), watch=False)
    still = np.zeros_like(calm.reference.angles[0])
    end = float(calm.reference.times[-1])
    for twin in made:
        for k in range(1, 6):
            twin.write(Command(end + 0.01 * k, still, still, still, calm.reference.angles[0]))
    fast, slow = made
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


def test_what_the_correction_reads_is_let_go_before_the_last_twin_is_measured(calm, monkeypatch):
    read, alive = [], []
    prepare, measure = closed_loop._inputs, Twin.measurements

    def remember(*given):
        rows = prepare(*given)
        read.append(ref(rows))
        return rows

    monkeypatch.setattr(closed_loop, "_inputs", remember)
    monkeypatch.setattr(Twin, "measurements", lambda self: alive.append(read[0]() is not None) or measure(self))
    dry_runs(calm.plan, (NOMINAL, PESSIMISTIC), watch=False)
    assert alive == [True, False]
