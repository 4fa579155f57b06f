from kinesic.bml.parse import parse
from kinesic.bml.schedule import schedule
from kinesic.motion.keys import Bond
from kinesic.planning.coupling import bonds

BLOCK = """<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">
  <gesture id="one" lexeme="BEAT" start="0" stroke="1" end="3"/>
  <gesture id="two" lexeme="BEAT" stroke="one:stroke+0.5"/>
  <gesture id="three" lexeme="BEAT" start="4"/>
  <constraint><after ref="one:end"><sync ref="three:start"/></after></constraint>
</bml>"""


def test_ties_between_behaviours_bind_both_ways_and_orders_one_way():
    block = parse(BLOCK)
    natural = {name: {"ready": 0.3, "stroke": 0.2, "relax": 0.1, "end": 0.3} for name in ("one", "two", "three")}
    found = set(bonds(schedule(block, {}, natural)))
    one, two = ("one", "stroke"), ("two", "stroke")
    assert {bond for bond in found if {bond.earlier, bond.later} == {one, two}} == {
        Bond(two, one, -0.5),
        Bond(one, two, 0.5),
    }
    assert Bond(("one", "end"), ("three", "start"), 0.0) in found
    assert not [bond for bond in found if bond.earlier[0] == bond.later[0]]
