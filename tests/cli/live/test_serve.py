import re
import socket
import sys

import pytest

from kinesic.body.config import ConfigError
from kinesic.cli import main
from kinesic.cli.live.addresses import read_listen_address
from kinesic.cli.live.serve import read_rules
from kinesic.serve.server import Address
from kinesic.serve.wire.quotas import DEFAULT_QUOTAS

pytestmark = pytest.mark.realtime

NOD = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{}"><head id="h" lexeme="NOD" start="0"/></bml>'


@pytest.mark.parametrize(
    ("text", "token", "address"),
    [
        ("none", None, None),
        ("127.0.0.1:0", None, Address("127.0.0.1", 0)),
        ("localhost:80", None, Address("localhost", 80)),
        ("[::1]:80", None, Address("::1", 80)),
        ("0.0.0.0:80", "t", Address("0.0.0.0", 80)),
    ],
)
def test_valid_server_addresses_are_parsed(text, token, address):
    assert read_listen_address(text, token) == address


@pytest.mark.parametrize("text", ["0.0.0.0:80", "[::]:80", "robot.local:80", "192.168.0.2:80"])
@pytest.mark.parametrize("token", [None, ""])
def test_server_on_a_public_address_requires_a_token(text, token):
    with pytest.raises(ConfigError, match="give --token-file, or set KINESIC_TOKEN"):
        read_listen_address(text, token)


@pytest.mark.parametrize("text", ["", "80", "localhost", "localhost:", "localhost:x", "localhost:99999"])
def test_invalid_server_address_is_refused(text):
    with pytest.raises(ConfigError, match=r"give HOST:PORT"):
        read_listen_address(text, None)


def test_server_rule_option_changes_only_the_named_client_quota():
    assert read_rules(()) == DEFAULT_QUOTAS
    changed = read_rules(("rate=5", "message=100"))
    assert (changed.rate, changed.message, changed.depth) == (5.0, 100, DEFAULT_QUOTAS.depth)


@pytest.mark.parametrize(
    ("text", "why"), [("rat=5", "did you mean"), ("rate=fast", "fast"), ("depth=0", "above 0"), ("rate", "could not")]
)
def test_invalid_client_quota_rules_of_the_server_are_refused(text, why):
    with pytest.raises(ConfigError, match=why):
        read_rules((text,))


def test_server_address_that_is_read_and_printed_gives_the_same_text():
    for text in ("127.0.0.1:5", "[::1]:5"):
        assert str(read_listen_address(text, None)) == text


@pytest.fixture
def run_with_input(tmp_path, monkeypatch):
    """Return a function that runs a verb with files as standard input and output, whose descriptors it uses."""

    def run(text, *arguments):
        (tmp_path / "input").write_text(text)
        output = tmp_path / "output"
        with (tmp_path / "input").open() as stdin, output.open("w") as stdout, monkeypatch.context() as patch:
            patch.setattr(sys, "argv", ["kinesic", *arguments])
            patch.setattr(sys, "stdin", stdin)
            patch.setattr(sys, "stdout", stdout)
            with pytest.raises(SystemExit) as end:
                main()
        assert not end.value.code
        return output.read_text()

    return run


def test_server_performs_blocks_from_standard_input_and_then_ends(run_with_input, capsys):
    blocks = NOD.format("one") + "\0" + NOD.format("two").replace(" id", ' composition="APPEND" id', 1)
    output = run_with_input(blocks, "serve", "--voice", "durations", "--listen", "none")
    ends = re.findall(r'blockProgress[^>]* id="(\w+:\w+)"', output)
    assert ends == [f"{name}:{point}" for name in ("one", "two") for point in ("start", "relax", "end")]
    assert all(line.startswith("<") for line in output.splitlines())
    assert "reading standard input" in capsys.readouterr().err


def test_say_command_prints_the_words_of_standard_input_as_spoken(run_with_input):
    output = run_with_input("Hello, my friend! Look", "say", "-", "--voice", "durations")
    assert output.split() == ["Hello,", "my", "friend!", "Look"]


def test_server_address_in_use_is_reported_in_one_line(kinesic):
    with socket.create_server(("127.0.0.1", 0)) as listener:
        address = f"127.0.0.1:{listener.getsockname()[1]}"
        ended = kinesic("serve", "--voice", "durations", "--listen", address)
    assert ended.code == 2
    assert re.fullmatch(r"kinesic: .*address already in use.*\n", ended.err)
