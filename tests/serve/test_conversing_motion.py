"""Motion that a conversation proposes, compared with single steps of following."""

from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.conversation.wants import BodyLean, Look, Nod
from kinesic.expressivity.keyframes import HeldTurns, Turn
from kinesic.expressivity.turns import UPRIGHT_TURN
from kinesic.planning.setup import Setup
from kinesic.realizer.following import follow, nod
from kinesic.realizer.scene import Scene
from kinesic.serve import conversing
from kinesic.serve.conversing import RETRY_PERIOD, Conversation


class Proposals:
    """Scene whose proposed changes are kept."""

    def __init__(self, known: Setup) -> None:
        self.scene, self.changes = Scene.of(known), []

    def propose(self, change) -> None:
        self.changes.append(change)

    def tell(self, message: str, client: int) -> None:
        """Ignore messages."""


@pytest.fixture
def proposals(known: Setup) -> Proposals:
    return Proposals(known)


@pytest.fixture
def conversation(proposals: Proposals) -> Conversation:
    return Conversation(proposals, shows_eyes=False)


def test_nod_of_a_listener_is_scaled_by_the_style(conversation, proposals, known):
    conversation._move([Nod(4.0, "the speaker pauses")], 0.0)
    (change,) = proposals.changes
    amplitude = 1.0 + 0.5 * known.style.head.spatial
    expected = nod(proposals.scene, np.radians(4.0) * amplitude, 0.0)
    np.testing.assert_allclose(change(proposals.scene, 0.0).motion.controls, expected.motion.controls, atol=1e-12)
    assert not np.array_equal(expected.motion.controls, proposals.scene.motion.controls)


@pytest.mark.parametrize("is_held", [False, True])
def test_listener_leans_unless_a_block_holds_a_posture(conversation, proposals, monkeypatch, is_held):
    held = SimpleNamespace(holds=lambda role: role == "trunk", behaviour="b:posture")
    others = [SimpleNamespace(holds=lambda role: role == "look", behaviour="b:gaze")]
    followed = SimpleNamespace(holds=lambda role: role == "trunk", behaviour="conversation:trunk")
    assert conversing._holds_posture(SimpleNamespace(lasting=[followed, *others])) is False
    assert conversing._holds_posture(SimpleNamespace(lasting=[followed, held])) is True
    monkeypatch.setattr(conversing, "_holds_posture", lambda scene: is_held)
    conversation._move([BodyLean(lean=2.0, tilt=5.0)], 0.0)
    after = proposals.changes[0](proposals.scene, 0.0)
    assert (after.motion is proposals.scene.motion) == is_held


def test_following_a_person_is_retried_only_while_a_block_determines_the_gaze(conversation, monkeypatch):
    for is_elsewhere, retry in ((True, 3.0 + RETRY_PERIOD), (False, float("inf"))):
        monkeypatch.setattr(conversing, "is_looking_elsewhere", lambda scene, now, answer=is_elsewhere: answer)
        conversation._move([Look((1.5, 0.2, 1.4))], 3.0)
        assert conversation._retry == retry
        assert conversation.look == Look((1.5, 0.2, 1.4))


def test_conversation_proposes_motion_only_for_a_new_gaze_or_a_due_retry(conversation, proposals, monkeypatch):
    conversation._move([], 1.0)
    assert not proposals.changes
    monkeypatch.setattr(conversing, "is_looking_elsewhere", lambda scene, now: True)
    conversation._move([Look(None)], 1.0)
    conversation._move([], 1.0 + 0.9 * RETRY_PERIOD)
    assert len(proposals.changes) == 1
    conversation._move([], 1.0 + RETRY_PERIOD)
    assert len(proposals.changes) == 2


def test_trunk_turn_while_following_a_person_is_upright_unless_a_gaze_has_turned_the_trunk(proposals, known):
    scene = proposals.scene
    assert conversing._followed_torso(scene) == UPRIGHT_TURN
    lean = HeldTurns("posture", Turn(), Turn(tilt=np.radians(2.0)))
    leaning = follow(scene, lean, 0.0)
    assert conversing._followed_torso(leaning) == UPRIGHT_TURN
    looking = follow(leaning, HeldTurns("look", Turn(np.radians(40.0)), Turn(np.radians(10.0))), 0.0)
    assert len(looking.lasting) == 2
    assert np.degrees(conversing._followed_torso(looking).torsion) == pytest.approx(10.0, abs=0.1)
