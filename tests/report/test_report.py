"""What the report says of style and manners."""

from dataclasses import replace

import pytest

from kinesic.controller.perform import perform
from kinesic.expressivity.style.style import RANGES, style_preset
from kinesic.planning.setup import Setup
from kinesic.report.report import Json, report

BML = """
<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" xmlns:kinesic="urn:kinesic" id="b" kinesic:head.fluidity="0.5">
  <head id="h" lexeme="NOD" start="0" kinesic:power="-0.5"/>
  <wait id="w" duration="0.1"/>
</bml>
"""


@pytest.fixture(scope="module")
def data(known: Setup) -> dict[str, Json]:
    style = style_preset("calm").changed(["head.spatial=0.25"])
    return report(perform(BML, replace(known, style=style)), source="x.bml")


def test_the_style_has_a_table_for_each_modality_and_what_was_said_beside_it(data: dict[str, Json]) -> None:
    style = data["style"]
    assert style["name"] == "calm"
    assert {name: style[name] for name in RANGES} == style["gesture"]
    assert (style["head"]["spatial"], style["torso"]["spatial"]) == (0.25, style_preset("calm").torso.spatial)
    assert style["settings"] == ["head.spatial=0.25"]
    assert style["block"] == {"head": {"fluidity": 0.5}}


def test_a_behaviour_has_its_numbers_and_who_said_them(data: dict[str, Json]) -> None:
    nod, wait = data["behaviours"]
    told = {"power": (-0.5, "behaviour"), "fluidity": (0.5, "block"), "spatial": (0.25, "setting")}
    for name, own in vars(style_preset("calm").head).items():
        value, source = told.get(name, (own, "style"))
        assert (nod["manner"]["values"][name], nod["manner"]["sources"][name]) == (value, source)
    assert (nod["manner"]["modality"], nod["manner"]["intensity"]) == ("head", None)
    assert wait["manner"] is None
