import json

import pytest
from click.testing import CliRunner

from kinesic.cli.live.say import _show
from kinesic.cli.verbs import kinesic


def test_standard_input_can_be_written_as_bml():
    done = CliRunner().invoke(kinesic, ["say", "-", "--to", "bml"], input="Hello there!")
    assert done.exit_code == 0
    assert "there!" in done.stdout
    assert "<gesture" in done.stdout


def test_words_that_come_one_by_one_have_no_report():
    done = CliRunner().invoke(kinesic, ["say", "-", "--out", "there"], input="")
    assert done.exit_code != 0
    assert "leave no report" in str(done.exception)


@pytest.mark.parametrize(
    ("message", "out", "err"),
    [
        (json.dumps({"told": "saying", "block": "b", "text": "Hello \x1b[2J"}), "Hello", ""),
        (json.dumps({"told": "refused", "why": "no such thing"}), "", "no such thing"),
        (json.dumps({"told": "all_said", "block": "b"}), "", ""),
        ('<warningFeedback id="b">rule waiting: a &lt; b</warningFeedback>', "", "a < b"),
        ('<warningFeedback id="b:g1">left out: no hand</warningFeedback>', "", "no hand"),
        ('<warningFeedback id="b:g1">stroke asked at 1 s is planned at 2 s</warningFeedback>', "", ""),
    ],
)
def test_words_are_shown_as_they_are_said_and_losses_are_told(message, out, err, capsys):
    _show(message)
    said = capsys.readouterr()
    assert out in said.out
    assert bool(said.out) is bool(out)
    assert err in said.err
    assert bool(said.err) is bool(err)
    assert "\x1b" not in said.out
