from dataclasses import replace

import mujoco
import numpy as np
import pytest
from numpy.random import default_rng

from kinesic.bench import ik
from kinesic.bench.ik import peer_solvers, peers
from kinesic.bench.ik.arms import targets
from kinesic.bench.ik.peer_solvers import HAND, PEERS, Peer, carriers, urdf
from kinesic.body.robot import Robot
from kinesic.ik import KERNEL

compiled = pytest.mark.skipif(KERNEL != "compiled", reason="peers are compared with the compiled kernel")
libraries = pytest.mark.filterwarnings("ignore")  # theirs are not ours to mend


@pytest.fixture
def chain():
    return Robot.load().arms["l"]


@pytest.fixture
def few(monkeypatch):
    monkeypatch.setattr(peers, "TARGETS", 5)


def test_mujoco_finds_the_hand_of_the_urdf_where_the_chain_has_it(chain):
    model = mujoco.MjModel.from_xml_string(urdf(chain))
    data, chance, count = mujoco.MjData(model), default_rng(2), len(carriers(chain))
    assert model.nq == count
    np.testing.assert_allclose(model.jnt_range, np.stack([chain.lower, chain.upper], axis=1)[:count])
    for _ in range(20):
        angles = chance.uniform(chain.lower, chain.upper)
        data.qpos[:] = angles[:count]
        mujoco.mj_kinematics(model, data)
        np.testing.assert_allclose(data.body(HAND).xpos, chain.hand(angles), atol=1e-9)


def test_the_hinges_of_the_hand_itself_do_not_carry_it(chain):
    angles = chain.upper.copy()
    moved = angles.copy()
    moved[len(carriers(chain)) :] = chain.lower[len(carriers(chain)) :]
    np.testing.assert_allclose(chain.hand(angles), chain.hand(moved), atol=1e-12)


def test_success_is_the_hand_within_a_millimetre_and_the_limits(chain):
    inside, outside = chain.rest, chain.upper + 0.01
    asked = np.array([chain.hand(inside), chain.hand(outside), chain.hand(inside) + 0.002])
    replies = {asked[0].tobytes(): inside, asked[1].tobytes(): outside, asked[2].tobytes(): inside}
    calls = peers.interleave(chain, {"x": lambda target: replies[target.tobytes()]}, asked)["x"]
    assert calls.reached.tolist() == [1.0, 0.0, 0.0]
    assert calls.microseconds > 0


def _recording(chain, names, order):
    """Solvers that write down in what order they are called."""

    def solver(name):
        def solve(target):
            order.append((name, tuple(target)))
            return chain.rest

        return solve

    return {name: solver(name) for name in names}


def test_each_target_goes_to_every_solver_before_the_next(chain):
    order, asked = [], targets(default_rng(1), chain, 3)
    peers.interleave(chain, _recording(chain, "ab", order), asked)
    assert order[2:] == [(name, tuple(target)) for target in asked for name in "ab"]


def test_in_a_round_each_solver_has_a_block_of_targets_in_a_row_and_each_block_begins_with_another_solver(
    monkeypatch, chain
):
    monkeypatch.setattr(peers, "BLOCK", 2)
    order, asked = [], targets(default_rng(1), chain, 7)
    calls = peers.take_turns(chain, _recording(chain, "abc", order), asked)
    turns = zip((asked[:2], asked[2:4], asked[4:6], asked[6:]), ("abc", "bca", "cab", "abc"), strict=True)
    assert order[3:] == [(name, tuple(target)) for block, names in turns for name in names for target in block]
    assert all((call.seconds > 0.0).all() for call in calls.values())


def test_a_round_counts_success_for_each_target(monkeypatch, chain):
    monkeypatch.setattr(peers, "BLOCK", 2)
    off = np.array([0.0, 0.002, 0.0, 0.0, 0.002])
    asked = chain.hand(chain.rest) + np.outer(off, [0.0, 0.0, 1.0])
    calls = peers.take_turns(chain, {"x": lambda target: chain.rest}, asked)["x"]
    assert calls.reached.tolist() == [1.0, 0.0, 1.0, 1.0, 0.0]


@compiled
@pytest.mark.usefixtures("few")
def test_without_the_libraries_each_figure_says_how_to_get_them(monkeypatch):
    monkeypatch.setattr(peers, "find_spec", lambda name: None)
    figures = {figure.name: figure for figure in peers.bench()}
    for peer in PEERS:
        ratios = [f"{kind}_{entry}" for kind in ("ratio", "one_round", "cold_caches") for entry in ("solve", "reach")]
        for what in ("us", "success", *ratios):
            figure = figures[f"ik.peer_{peer.name}_{what}"]
            assert figure.value is None
            assert figure.why == f"{peer.package} is not installed: pip install kinesic[bench]"
    assert figures["ik.peer_kinesic_solve_success"].value == 1.0
    assert figures["ik.peer_kinesic_reach_us"].value > 0


def test_without_the_kernel_each_figure_says_so(monkeypatch):
    monkeypatch.setattr(peers, "KERNEL", "numpy")
    assert {(figure.value, figure.why) for figure in peers.bench()} == {(None, "the kernel is not compiled here")}


@compiled
@pytest.mark.usefixtures("few")
def test_a_peer_that_is_there_is_measured_against_both_entries(monkeypatch, chain):
    peer = Peer("numpy", "numpy", ("numpy",), lambda chain: lambda target: chain.rest)
    monkeypatch.setattr(peers, "PEERS", (peer,))
    figures = {figure.name: figure for figure in peers.bench()}
    assert figures["ik.peer_numpy_success"].value == 0.0
    assert figures["ik.peer_numpy_us"].why == f"numpy {np.__version__}"
    for kind in ("ratio", "one_round", "cold_caches"):
        for entry in ("solve", "reach"):
            assert figures[f"ik.peer_numpy_{kind}_{entry}"].value > 0


@pytest.mark.parametrize(("kind", "goal"), [("ratio", 5.0), ("one_round", 10.0), ("cold_caches", None)])
def test_a_tenth_of_roboticstoolboxs_time_is_the_goal_of_a_round_and_cold_caches_have_none(kind, goal):
    calls = {
        "roboticstoolbox": peers.Calls(np.full(3, 9e-5), np.ones(3)),
        peers.SOLVE: peers.Calls(np.full(3, 1e-5), np.ones(3)),
    }
    figure = peers._ratio(PEERS[0], kind, peers.SOLVE, calls, "")
    assert (figure.value, figure.goal) == (pytest.approx(9.0), goal)


@libraries
@pytest.mark.parametrize("peer", PEERS, ids=lambda peer: peer.name)
def test_an_installed_library_reaches_a_nearby_target(peer, chain):
    if not peers.installed(peer):
        pytest.skip(f"{peer.package} is not installed")
    target = chain.hand(np.clip(chain.rest + 0.1, chain.lower, chain.upper))
    assert np.linalg.norm(chain.hand(peer.build(chain)(target)) - target) < peers.MM


@libraries
def test_an_oblique_axis_has_no_elementary_transform(chain):
    pytest.importorskip("roboticstoolbox")
    carrier = carriers(chain)[0]
    oblique = replace(carrier, hinge=replace(carrier.hinge, axis=np.array([0.6, 0.8, 0.0])))
    with pytest.raises(ValueError, match="no elementary transform"):
        peer_solvers._turn(oblique)


def test_the_room_shows_them(monkeypatch):
    for part in (part for part in ik.PARTS if part is not peers):
        monkeypatch.setattr(part, "bench", list)
    monkeypatch.setattr(peers, "bench", lambda: ["peers"])
    assert ik.bench() == ["peers"]


def test_the_picture_shows_those_that_were_measured(tmp_path):
    values = {
        f"ik.peer_{name}_{unit}": 1.0
        for name in ("kinesic_solve", "kinesic_reach", "mink")
        for unit in ("us", "success")
    }
    assert peers.draw(values, tmp_path / "peers.png").stat().st_size > 5000
