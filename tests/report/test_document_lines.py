"""Document text on the report's page."""

from kinesic.bml.parse import parse
from kinesic.metrics.dry_run import DryRun
from kinesic.planning.setup import Setup
from kinesic.report.document_lines import MAX_LISTED_LINES, document_lines
from kinesic.session.plan import plan


def test_document_lines_list_behaviours_that_begin_on_them(hurried: DryRun, known: Setup):
    (only,) = document_lines(hurried.plan.timeline.block)
    assert [behaviour.id for behaviour in only.behaviours] == ["s", "rushed", "odd", "nod"]
    rows = document_lines(plan('<bml id="b">\n\n<head id="h"\n lexeme="NOD"/></bml>', known).timeline.block)
    begun = [(row.number, [behaviour.id for behaviour in row.behaviours]) for row in rows]
    assert begun == [(1, []), (2, []), (3, ["h"]), (4, [])]


def test_document_lines_are_split_only_at_xml_line_ends():
    block = parse('<bml id="b">\r\n<!-- \u2028 -->\r<head id="h" lexeme="NOD"/>\n</bml>\r\n\n')
    rows = [(row.number, [behaviour.id for behaviour in row.behaviours]) for row in document_lines(block)]
    assert rows == [(1, []), (2, []), (3, ["h"]), (4, [])]


def test_document_listing_is_truncated_to_the_maximum_number_of_lines():
    assert len(document_lines(parse('<bml id="b">' + "\n" * 2 * MAX_LISTED_LINES + "</bml>"))) == MAX_LISTED_LINES
