import json

import pytest
from click.testing import CliRunner

from kinesic.cli.live.say import _print_message
from kinesic.cli.verbs import kinesic


def test_say_prints_standard_input_as_bml():
    done = CliRunner().invoke(kinesic, ["say", "-", "--to", "bml"], input="Hello there!")
    assert done.exit_code == 0
    assert "there!" in done.stdout
    assert "<gesture" in done.stdout


def test_say_from_standard_input_refuses_option_out():
    done = CliRunner().invoke(kinesic, ["say", "-", "--out", "there"], input="")
    assert done.exit_code != 0
    assert "has no report" in str(done.exception)


@pytest.mark.parametrize(
    ("message", "out", "err"),
    [
        (json.dumps({"told": "saying", "block": "b", "text": "Hello \x1b[2J"}), "Hello", ""),
        (json.dumps({"told": "refused", "why": "no such thing"}), "", "no such thing"),
        (json.dumps({"told": "all_said", "block": "b"}), "", ""),
        ('<warningFeedback id="b">rule waiting: a &lt; b</warningFeedback>', "", "a < b"),
        ('<warningFeedback id="b:g1">left out: no hand</warningFeedback>', "", "no hand"),
        ('<warningFeedback id="b:g1">stroke requested at 1 s is planned at 2 s</warningFeedback>', "", ""),
    ],
)
def test_say_prints_spoken_text_and_reasons_for_omitted_behaviours(message, out, err, capsys):
    _print_message(message)
    captured = capsys.readouterr()
    assert out in captured.out
    assert bool(captured.out) is bool(out)
    assert err in captured.err
    assert bool(captured.err) is bool(err)
    assert "\x1b" not in captured.out
