from dataclasses import replace

import pytest

from kinesic.bml.block import Behaviour, Block, Gesture, Manner, Place
from kinesic.body.config import ConfigError
from kinesic.expressivity.style.resolve import ACTIVATION_FRACTIONS, fold_activation, resolve_numbers, resolve_styles
from kinesic.expressivity.style.style import EXPRESSIVITY_RANGES, MODALITIES, Expressivity, Style, style_preset


def test_full_activation_raises_parameters_by_their_activation_fractions():
    folded = fold_activation(Expressivity(activation=1.0))
    assert {name: getattr(folded, name) for name in ACTIVATION_FRACTIONS} == pytest.approx(dict(ACTIVATION_FRACTIONS))
    assert all(getattr(folded, name) == 0.0 for name in EXPRESSIVITY_RANGES if name not in ACTIVATION_FRACTIONS)


def test_lowest_activation_moves_expressivity_parameters_towards_their_lower_limits():
    folded = fold_activation(Expressivity(spatial=-0.5, openness=0.5, activation=-1.0))
    assert folded.spatial == pytest.approx(-0.5 - 0.5 * ACTIVATION_FRACTIONS["spatial"])
    assert folded.openness == pytest.approx(0.5 * (1 - ACTIVATION_FRACTIONS["openness"]))


def test_activation_parameter_of_a_style_is_zero_after_it_has_been_applied():
    once = fold_activation(Expressivity(power=0.3, activation=0.7))
    assert once.activation == 0.0
    assert fold_activation(once) == once


def behaviour(action=None, manner=None):
    return Behaviour("b", "x", action or Gesture("beat"), Place(1, 1), manner=manner or Manner())


def test_document_without_parameters_keeps_the_style():
    resolved = resolve_numbers(style_preset("sad"), "head", Block("b", ()), behaviour())
    assert resolved.expressivity == style_preset("sad").head
    assert resolved.sources == dict.fromkeys(EXPRESSIVITY_RANGES, "style")


def test_setting_behaviour_and_block_override_single_style_parameters():
    style = style_preset("sad").changed(["head.power=0.9", "gesture.spatial=0.7"])
    block = Block("b", (), manners={"gesture": Manner(spatial=0.1, temporal=0.2, power=0.3)})
    resolved = resolve_numbers(style, "gesture", block, behaviour(manner=Manner(power=-0.4, intensity=0.3)))
    expected = {"spatial": 0.7, "temporal": 0.2, "power": -0.4}
    assert resolved.expressivity == replace(style_preset("sad").gesture, **expected)
    spoken = {"spatial": "setting", "temporal": "block", "power": "behaviour"}
    assert resolved.sources == {**dict.fromkeys(EXPRESSIVITY_RANGES, "style"), **spoken}


def test_block_parameters_apply_to_their_modality_only():
    block = Block("b", (), manners={"head": Manner(power=0.3)})
    assert resolve_numbers(Style(), "head", block, behaviour()).expressivity.power == 0.3
    assert resolve_numbers(Style(), "gesture", block, behaviour()).expressivity.power == 0.0


def test_style_preset_of_a_document_replaces_all_parameters_except_explicit_ones():
    block = Block("b", (), manners={"head": Manner(power=0.3, style="sad")})
    resolved = resolve_numbers(style_preset("joyful"), "head", block, behaviour())
    assert resolved.expressivity == replace(style_preset("sad").head, power=0.3)
    assert set(resolved.sources.values()) == {"block"}
    over = resolve_numbers(
        style_preset("joyful").changed(["power=0"]), "head", block, behaviour(manner=Manner(style="calm"))
    )
    assert over.expressivity == replace(style_preset("calm").head, power=0.0)
    assert over.sources == {**dict.fromkeys(EXPRESSIVITY_RANGES, "behaviour"), "power": "setting"}


def test_error_for_an_unknown_style_preset_of_a_behaviour_suggests_the_nearest_preset():
    with pytest.raises(ConfigError, match=r"no style joyfull; did you mean joyful\?"):
        resolve_numbers(Style(), "head", Block("b", ()), behaviour(manner=Manner(style="joyfull")))


def test_style_is_resolved_separately_for_each_behaviour():
    said = replace(behaviour(manner=Manner(power=0.9)), id="c")
    block = Block("b", (behaviour(), said), manners={"head": Manner(power=-0.5)})
    styles = resolve_styles(Style("mine", *(Expressivity(power=power) for power in (0.1, 0.2, 0.3, 0.4))), block)
    assert [styles["b"].of(modality).power for modality in MODALITIES] == [0.1, -0.5, 0.3, 0.4]
    assert [styles["c"].of(modality).power for modality in MODALITIES] == [0.9] * 4


def test_activation_is_applied_to_the_resolved_style_of_a_behaviour():
    block = Block("b", (behaviour(manner=Manner(activation=0.5)),))
    assert resolve_styles(Style(), block)["b"].head == fold_activation(Expressivity(activation=0.5))


def test_style_named_in_a_document_sets_the_body_motion_weight():
    def weight(style: Style, named: str | None, own: str | None = None) -> float:
        block = Block("b", (behaviour(manner=Manner(style=own)),), manners={"gesture": Manner(style=named)})
        return resolve_styles(style, block)["b"].whole_body

    shy, angry = style_preset("shy").whole_body, style_preset("angry").whole_body
    assert (weight(Style(), "shy"), weight(Style(), "shy", "angry"), weight(style_preset("shy"), None)) == (
        shy,
        angry,
        shy,
    )
    assert weight(Style().changed(["whole_body=0"]), "shy") == 0.0
    assert weight(Style().changed(["effort=0"]), "shy") == shy


def test_effort_weight_comes_from_style_or_document_preset():
    own, plain = Style().changed(["effort=0"]), replace(Style(), effort=0.25)
    named = Block("b", (behaviour(),), manners={"gesture": Manner(style="shy")})
    efforts = [
        resolve_styles(style, block)["b"].effort
        for style in (own, plain)
        for block in (Block("b", (behaviour(),)), named)
    ]
    assert efforts == [0.0, 0.0, 0.25, 1.0]
