import os
from pathlib import Path

import pytest

from kinesic.body.config import ConfigError
from kinesic.intent.fml.author import author_fml
from kinesic.intent.greta.agent import Agent, read_agent

CORPUS_FOLDER = Path(os.environ.get("KINESIC_CORPUS", Path(__file__).parents[4] / "shared" / "corpus"))
BASELINE_XML = """<profile><parameter-set name="gesture">
  <Parameter name="SPC" value="0.25" min="-1" max="0.5"/><Parameter name="PWR.value" value="-0.5"/>
  <Parameter name="FLD" value="0.5"/><Parameter name="OAC" value="0.75"/>
  <Parameter name="preference.value" value="0.5"/>
</parameter-set><parameter-set name="gaze"><Parameter name="SPC" value="1"/></parameter-set></profile>"""
STEP_XML = """<modulation><destination>gesture</destination><parameter>{}</parameter><operator>{}</operator>
<op1_name>gesture</op1_name><op1_attribute>{}</op1_attribute>{}</modulation>"""
QUALIFIER_XML = f"""<qualifiers><qualifier name="emotion-*">
{STEP_XML.format("SPC.value", "ADD", "SPC.value", "<op2_value>0.5</op2_value>")}
{STEP_XML.format("SPC.value", "LIM", "SPC.min", "<op2_name>gesture</op2_name><op2_attribute>SPC.max</op2_attribute>")}
{STEP_XML.format("OAC.value", "LIM", "OAC.min", "<op2_name>gesture</op2_name><op2_attribute>OAC.max</op2_attribute>")}
{STEP_XML.format("FLD.value", "SUB", "FLD.value", "<op2_value>0.25</op2_value>")}
{STEP_XML.format("PWR.value", "INTENSIFY", "PWR.value", "")}
</qualifier><qualifier name="emotion-calm">
<modulation><destination>gesture</destination><parameter>PWR.value</parameter>
<operator>VAL</operator><op1_value>-2</op1_value></modulation></qualifier></qualifiers>"""


@pytest.fixture
def agent(tmp_path):
    (tmp_path / "baseline.xml").write_text(BASELINE_XML)
    (tmp_path / "qualifiers.xml").write_text(QUALIFIER_XML)
    return read_agent(tmp_path / "baseline.xml", tmp_path / "qualifiers.xml")


def test_qualifiers_of_a_greta_agent_modify_its_baseline_expressivity_by_intention(agent):
    assert agent.manner("world-x", "gesture") == {"spatial": 0.25, "power": -0.5, "fluidity": 0.5}
    assert agent.manner("Emotion-joy", "gesture", 0.5) == {"spatial": 0.5, "power": 0.25, "fluidity": 0.25}
    assert agent.manner("emotion-calm", "gesture")["power"] == -1.0, "its own, not that of its kind, and in range"
    assert agent.manner("emotion-joy", "gaze") == {}, "BML has no manner of looks"


def test_missing_weights_of_a_greta_agent_have_defaults(agent):
    assert agent.weight("emotion-joy", "gesture", "OAC") == 0.75
    assert agent.weight("world-x", "gesture", "preference") == 0.5
    assert Agent().weight("world-x", "gesture", "OAC") == 1.0


def test_generated_bml_contains_the_agents_expressivity(agent):
    fml = '<fml-apml><bml/><fml><performative type="greet" start="1"/></fml></fml-apml>'
    assert 'kinesic:spatial="0.25"' in author_fml(fml, agent=agent)[0]
    assert "kinesic:spatial" not in author_fml(fml)[0]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (QUALIFIER_XML.replace("SUB", "MUL"), "operator 'MUL'"),
        (QUALIFIER_XML.replace("<op1_value>-2", "<op1_value>low"), "'low' in <op1_value> is no number"),
        (QUALIFIER_XML.replace("<destination>gesture</destination>", "", 1), "has no <destination>"),
    ],
)
def test_invalid_qualifiers_of_a_greta_agent_are_refused(tmp_path, text, says):
    (tmp_path / "q.xml").write_text(text)
    with pytest.raises(ConfigError, match=says):
        read_agent(None, tmp_path / "q.xml")


@pytest.mark.skipif(not CORPUS_FOLDER.is_dir(), reason=f"no corpus at {CORPUS_FOLDER}")
def test_baselines_of_the_greta_corpus_differ_in_spatial_extent_by_emotion():
    folder = CORPUS_FOLDER / "greta/behaviorplanner"
    wide = {}
    for name in ("happy", "neutral", "sad"):
        agent = read_agent(folder / f"Baseline/baseline_{name}.xml", folder / "Qualifier/behaviorqualifiers.xml")
        wide[name] = agent.manner("emotion-joy", "gesture")["spatial"]
        assert len(agent.qualifiers) == 15
    assert wide["sad"] < wide["neutral"] < wide["happy"] == 1.0
