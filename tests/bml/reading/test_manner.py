import pytest

from kinesic.bml.block import BmlError, Manner, NoticeType
from kinesic.bml.parse import parse
from kinesic.bml.reading.manner import scale_openness

XML_NAMESPACES = 'xmlns="http://www.bml-initiative.org/bml/bml-1.0" xmlns:kinesic="urn:kinesic"'


def parse_block(inside, attributes="", namespaces=XML_NAMESPACES):
    return parse(f'<bml {namespaces} id="b" {attributes}>\n{inside}\n</bml>')


def manner(inside):
    return parse_block(inside).behaviours[0].manner


def greta(values):
    return f'<gesture id="g" lexeme="beat"><description type="gretabml">{values}</description></gesture>'


def test_kinesic_attributes_set_the_expressivity():
    block = parse_block(
        '<gesture id="g" lexeme="beat" kinesic:power="0.8" kinesic:style="joyful" kinesic:activation="-1"/>'
    )
    assert block.behaviours[0].manner == Manner(power=0.8, style="joyful", activation=-1.0)
    assert block.notices == ()


@pytest.mark.parametrize(
    "behaviour",
    [
        '<gesture id="x" lexeme="beat" {}/>',
        '<pointing id="x" target="left" {}/>',
        '<head id="x" lexeme="NOD" {}/>',
        '<gaze id="x" target="left" {}/>',
        '<gazeShift id="x" target="left" {}/>',
        '<faceLexeme id="x" lexeme="smile" {}/>',
        '<posture id="x" {}><stance type="STANDING"/></posture>',
    ],
)
def test_all_body_behaviours_accept_kinesic_attributes(behaviour):
    assert manner(behaviour.format('kinesic:fluidity="0.5"')) == Manner(fluidity=0.5)


def test_kinesic_attribute_of_a_motionless_behaviour_gives_a_notice():
    block = parse_block('<wait id="w" duration="1" kinesic:power="0.8"/>')
    (notice,) = block.notices
    assert (notice.type, notice.id) == (NoticeType.CUSTOM_ATTRIBUTE_NOT_SUPPORTED, "b:w")
    assert "kinesic:power" in notice.text


def test_kinesic_attributes_are_recognised_by_namespace_before_prefix():
    bml = 'xmlns="http://www.bml-initiative.org/bml/bml-1.0"'
    named = parse_block('<head id="h" lexeme="NOD" k:power="0.8"/>', namespaces=f'{bml} xmlns:k="urn:kinesic"')
    assert named.behaviours[0].manner == Manner(power=0.8)
    undeclared = parse_block('<head id="h" lexeme="NOD" kinesic:power="0.8"/>', namespaces=bml)
    assert undeclared.behaviours[0].manner == Manner(power=0.8)
    foreign = parse_block(
        '<head id="h" lexeme="NOD" kinesic:power="0.8"/>', namespaces=f'{bml} xmlns:kinesic="urn:other"'
    )
    assert foreign.behaviours[0].manner == Manner()
    assert [notice.type for notice in foreign.notices] == [NoticeType.CUSTOM_ATTRIBUTE_NOT_SUPPORTED]


def test_kinesic_attributes_override_the_kinesic_description_element():
    inside = '<description type="kinesic"><power>0.2</power><kinesic:spatial> 1 </kinesic:spatial></description>'
    assert manner(f'<head id="h" lexeme="NOD">{inside}</head>') == Manner(power=0.2, spatial=1.0)
    assert manner(f'<head id="h" lexeme="NOD" kinesic:power="0.7">{inside}</head>') == Manner(power=0.7, spatial=1.0)


def test_block_expressivity_applies_to_all_modalities_or_to_a_named_one():
    block = parse_block('<wait id="w"/>', 'kinesic:head.power="-1" kinesic:power="0.8" kinesic:face.style="sad"')
    assert block.manners == {
        "gesture": Manner(power=0.8),
        "head": Manner(power=-1.0),
        "torso": Manner(power=0.8),
        "face": Manner(power=0.8, style="sad"),
    }
    assert parse_block('<wait id="w"/>', 'kinesic:head.power="-1"').manners == {"head": Manner(power=-1.0)}
    assert parse_block('<wait id="w"/>').manners == {}


@pytest.mark.parametrize(
    ("attribute", "message"),
    [
        ('kinesic:power="2"', r"<text>:2:1: kinesic:power='2' is out of range; use -1 to 1"),
        ('kinesic:openness="-0.5"', r"<text>:2:1: kinesic:openness='-0.5' is out of range; use 0 to 1"),
        ('kinesic:power="much"', r"<text>:2:1: kinesic:power='much' is not a number"),
        ('kinesic:power="nan"', r"<text>:2:1: kinesic:power='nan' is out of range"),
        ('kinesic:powr="1"', r"<text>:2:1: kinesic:powr is not a parameter; did you mean power\?"),
        ('kinesic:intensity="1"', r"<text>:2:1: kinesic:intensity is not a parameter"),
        ('kinesic:head.power="1"', r"<text>:2:1: kinesic:head.power is not a parameter"),
        ('kinesic:style="joyfull"', r"<text>:2:1: kinesic:style='joyfull' is not a style; did you mean joyful\?"),
        ('kinesic:style="../styles/sad"', r"<text>:2:1: kinesic:style='../styles/sad' is not a style"),
    ],
)
def test_invalid_kinesic_attributes_of_a_behaviour_are_rejected_with_line_and_column(attribute, message):
    with pytest.raises(BmlError, match=message):
        parse_block(f'<gesture id="g" lexeme="beat" {attribute}/>')


@pytest.mark.parametrize(
    ("attribute", "message"),
    [
        ('kinesic:hed.power="1"', r"<text>:1:1: kinesic:hed.power is not a modality; did you mean head\?"),
        ('kinesic:head.powr="1"', r"<text>:1:1: kinesic:head.powr is not a parameter; did you mean power\?"),
        ('kinesic:head.power="3"', r"<text>:1:1: kinesic:head.power='3' is out of range; use -1 to 1"),
    ],
)
def test_invalid_kinesic_attributes_of_a_block_are_rejected_with_line_and_column(attribute, message):
    with pytest.raises(BmlError, match=message):
        parse_block('<wait id="w"/>', attribute)


def test_invalid_description_element_is_rejected_with_line_and_column():
    with pytest.raises(BmlError, match=r"<text>:4:1: power='9' is out of range; use -1 to 1"):
        manner('<head id="h" lexeme="NOD">\n<description type="kinesic">\n<power>9</power></description></head>')


def test_greta_expressivity_is_read():
    expressivity = (
        "<SPC.value>0.4</SPC.value><TMP.value>-0.7</TMP.value><FLD.value>1</FLD.value><PWR.value>0.5</PWR.value>"
    )
    rest = "<REP.value>-0.1</REP.value><TEN.value>0</TEN.value><OPN.value>0</OPN.value><intensity>0.3</intensity>"
    assert manner(greta(expressivity + rest)) == Manner(
        spatial=0.4, temporal=-0.7, fluidity=1.0, power=0.5, repetition=-0.1, tension=0.0, openness=0.0, intensity=0.3
    )


def test_greta_values_out_of_range_are_clipped_with_a_notice():
    block = parse_block(greta("<SPC.value>1.5</SPC.value><OPN.value>-2</OPN.value><intensity>-1</intensity>"))
    assert block.behaviours[0].manner == Manner(spatial=1.0, openness=0.0, intensity=0.0)
    assert [notice.text for notice in block.notices] == [
        "SPC.value 1.5 is outside -1 to 1 and becomes 1",
        "OPN.value -2 is outside -0.7 to 1.13 and becomes -0.7",
        "intensity -1 is outside 0 to 1 and becomes 0",
    ]


def test_greta_openness_is_scaled_to_the_range_0_to_1():
    wide = [scale_openness(value) for value in (-0.7, -0.1, 0.0, 0.565, 1.13, 5.0)]
    assert wide == pytest.approx([0.0, 0.0, 0.0, 0.5, 1.0, 1.0])
    assert manner(greta("<OPN.value>0.565</OPN.value>")) == Manner(openness=0.5)


def test_kinesic_values_override_greta_values():
    both = greta("<PWR.value>0.1</PWR.value><SPC.value>0.3</SPC.value>").replace(
        "<gesture", '<gesture kinesic:power="1"'
    )
    assert manner(both) == Manner(power=1.0, spatial=0.3)
