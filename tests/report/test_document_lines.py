"""The document on the page."""

from kinesic.bml.parse import parse
from kinesic.controller.perform import perform
from kinesic.controller.performance import Performance
from kinesic.planning.setup import Setup
from kinesic.report.document_lines import MOST_LINES, document_lines


def test_lines_of_the_document_know_who_begins_there(hurried: Performance, known: Setup):
    (only,) = document_lines(hurried.plan.timeline.block)
    assert [behaviour.id for behaviour in only.behaviours] == ["s", "rushed", "odd", "nod"]
    rows = document_lines(perform('<bml id="b">\n\n<head id="h"\n lexeme="NOD"/></bml>', known).plan.timeline.block)
    begun = [(row.number, [each.id for each in row.behaviours]) for row in rows]
    assert begun == [(1, []), (2, []), (3, ["h"]), (4, [])]


def test_lines_end_where_those_of_xml_do():
    block = parse('<bml id="b">\r\n<!-- \u2028 -->\r<head id="h" lexeme="NOD"/>\n</bml>\r\n\n')
    rows = [(row.number, [each.id for each in row.behaviours]) for row in document_lines(block)]
    assert rows == [(1, []), (2, []), (3, ["h"]), (4, [])]


def test_a_long_document_is_cut():
    assert len(document_lines(parse('<bml id="b">' + "\n" * 2 * MOST_LINES + "</bml>"))) == MOST_LINES
