from dataclasses import replace

import mujoco
import numpy as np
import pytest
from numpy.random import default_rng

from kinesic.bench import ik
from kinesic.bench.ik import peer_solvers, peers
from kinesic.bench.ik.arms import draw_targets
from kinesic.bench.ik.peer_solvers import HAND_LINK, PEER_LIBRARIES, Peer, list_carriers, write_urdf
from kinesic.body.robot import Robot
from kinesic.extras import install_extra

ignore_library_warnings = pytest.mark.filterwarnings("ignore")  # warnings of other libraries cannot be fixed here


@pytest.fixture
def chain():
    return Robot.load().arms["l"]


@pytest.fixture
def few_targets(monkeypatch):
    monkeypatch.setattr(peers, "TARGET_COUNT", 5)


def test_mujoco_model_of_the_urdf_agrees_on_the_hand_position(chain):
    model = mujoco.MjModel.from_xml_string(write_urdf(chain))
    data, rng, count = mujoco.MjData(model), default_rng(2), len(list_carriers(chain))
    assert model.nq == count
    np.testing.assert_allclose(model.jnt_range, np.stack([chain.lower, chain.upper], axis=1)[:count])
    for _ in range(20):
        angles = rng.uniform(chain.lower, chain.upper)
        data.qpos[:] = angles[:count]
        mujoco.mj_kinematics(model, data)
        np.testing.assert_allclose(data.body(HAND_LINK).xpos, chain.hand(angles), atol=1e-9)


def test_joints_of_the_hand_itself_do_not_move_its_centre(chain):
    angles = chain.upper.copy()
    moved = angles.copy()
    moved[len(list_carriers(chain)) :] = chain.lower[len(list_carriers(chain)) :]
    np.testing.assert_allclose(chain.hand(angles), chain.hand(moved), atol=1e-12)


def test_ik_success_requires_an_error_below_1_mm_and_angles_within_limits(chain):
    inside, outside = chain.rest, chain.upper + 0.01
    requested = np.array([chain.hand(inside), chain.hand(outside), chain.hand(inside) + 0.002])
    replies = {requested[0].tobytes(): inside, requested[1].tobytes(): outside, requested[2].tobytes(): inside}
    calls = peers.interleave(chain, {"x": lambda target: replies[target.tobytes()]}, requested)["x"]
    assert calls.reached.tolist() == [1.0, 0.0, 0.0]
    assert calls.microseconds > 0


def _recording(chain, names, order):
    """Return solvers that record the order of their calls."""

    def solver(name):
        def solve(target):
            order.append((name, tuple(target)))
            return chain.rest

        return solve

    return {name: solver(name) for name in names}


def test_every_solver_solves_an_ik_target_before_the_next_target(chain):
    order, requested = [], draw_targets(default_rng(1), chain, 3)
    peers.interleave(chain, _recording(chain, "ab", order), requested)
    assert order[2:] == [(name, tuple(target)) for target in requested for name in "ab"]


def test_ik_solvers_are_timed_in_rotating_order_on_blocks_of_targets(monkeypatch, chain):
    monkeypatch.setattr(peers, "BLOCK_SIZE", 2)
    order, requested = [], draw_targets(default_rng(1), chain, 7)
    calls = peers.take_turns(chain, _recording(chain, "abc", order), requested)
    turns = zip(
        (requested[:2], requested[2:4], requested[4:6], requested[6:]), ("abc", "bca", "cab", "abc"), strict=True
    )
    assert order[3:] == [(name, tuple(target)) for block, names in turns for name in names for target in block]
    assert all((call.seconds > 0.0).all() for call in calls.values())


def test_ik_success_is_recorded_per_target_while_solvers_alternate(monkeypatch, chain):
    monkeypatch.setattr(peers, "BLOCK_SIZE", 2)
    off = np.array([0.0, 0.002, 0.0, 0.0, 0.002])
    requested = chain.hand(chain.rest) + np.outer(off, [0.0, 0.0, 1.0])
    calls = peers.take_turns(chain, {"x": lambda target: chain.rest}, requested)["x"]
    assert calls.reached.tolist() == [1.0, 0.0, 1.0, 1.0, 0.0]


@pytest.mark.usefixtures("few_targets")
def test_missing_ik_library_gives_null_metrics_with_a_remedy(monkeypatch):
    monkeypatch.setattr(peers, "find_spec", lambda name: None)
    metrics = {metric.name: metric for metric in peers.bench()}
    for peer in PEER_LIBRARIES:
        ratios = [f"{kind}_{entry}" for kind in ("ratio", "one_round", "cold_caches") for entry in ("solve", "reach")]
        for quantity in ("us", "success", *ratios):
            metric = metrics[f"ik.peer_{peer.name}_{quantity}"]
            assert metric.value is None
            assert metric.why == f"{peer.package} is not installed: {install_extra('bench')}"
    assert metrics["ik.peer_kinesic_solve_success"].value == 1.0
    assert metrics["ik.peer_kinesic_reach_us"].value > 0


@pytest.mark.usefixtures("few_targets")
def test_installed_ik_library_is_compared_with_kinesic_solve_and_reach(monkeypatch, chain):
    peer = Peer("numpy", "numpy", ("numpy",), lambda chain: lambda target: chain.rest)
    monkeypatch.setattr(peers, "PEER_LIBRARIES", (peer,))
    metrics = {metric.name: metric for metric in peers.bench()}
    assert metrics["ik.peer_numpy_success"].value == 0.0
    assert metrics["ik.peer_numpy_us"].why == f"numpy {np.__version__}"
    for kind in ("ratio", "one_round", "cold_caches"):
        for entry in ("solve", "reach"):
            assert metrics[f"ik.peer_numpy_{kind}_{entry}"].value > 0


@pytest.mark.parametrize(("kind", "goal"), [("ratio", 5.0), ("one_round", 10.0), ("cold_caches", None)])
def test_ik_time_ratio_goal_depends_on_the_kind_of_measurement(kind, goal):
    calls = {
        "roboticstoolbox": peers.Calls(np.full(3, 9e-5), np.ones(3)),
        peers.SOLVE_ENTRY: peers.Calls(np.full(3, 1e-5), np.ones(3)),
    }
    metric = peers._ratio(PEER_LIBRARIES[0], kind, peers.SOLVE_ENTRY, calls, "")
    assert (metric.value, metric.goal) == (pytest.approx(9.0), goal)


@ignore_library_warnings
@pytest.mark.parametrize("peer", PEER_LIBRARIES, ids=lambda peer: peer.name)
def test_installed_ik_library_reaches_a_nearby_target(peer, chain):
    if not peers.is_installed(peer):
        pytest.skip(f"{peer.package} is not installed")
    target = chain.hand(np.clip(chain.rest + 0.1, chain.lower, chain.upper))
    assert np.linalg.norm(chain.hand(peer.build(chain)(target)) - target) < peers.MAX_ERROR


@ignore_library_warnings
def test_ik_comparison_rejects_oblique_joint_axes(chain):
    pytest.importorskip("roboticstoolbox")
    carrier = list_carriers(chain)[0]
    oblique = replace(carrier, hinge=replace(carrier.hinge, axis=np.array([0.6, 0.8, 0.0])))
    with pytest.raises(ValueError, match="no elementary transform"):
        peer_solvers._make_rotation(oblique)


def test_ik_benchmark_includes_the_library_comparison(monkeypatch):
    for part in (part for part in ik.IK_PARTS if part is not peers):
        monkeypatch.setattr(part, "bench", list)
    monkeypatch.setattr(peers, "bench", lambda: ["peers"])
    assert ik.bench() == ["peers"]


def test_ik_library_comparison_plot_is_written(tmp_path):
    values = {
        f"ik.peer_{name}_{unit}": 1.0
        for name in ("kinesic_solve", "kinesic_reach", "mink")
        for unit in ("us", "success")
    }
    assert peers.draw(values, tmp_path / "peers.png").stat().st_size > 5000
