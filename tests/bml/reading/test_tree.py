"""Tests of XML trees and of documents rejected as XML."""

import pytest

from kinesic.bml.block import BmlError, DocumentBounds, Place
from kinesic.bml.reading.tree import read_tree


def test_xml_elements_have_line_and_column_of_their_start_tags() -> None:
    root = read_tree('<a>\n  <b\n  c="1">text<d/></b>\n</a>', source="x")
    (b,) = root.children
    assert (root.place, b.place, b.children[0].place) == (Place(1, 1), Place(2, 3), Place(3, 13))
    assert b.content[0] == "text"


def test_xml_namespaces_are_inherited_and_undeclared_prefixes_kept() -> None:
    root = read_tree('<a xmlns="u" xmlns:p="v"><p:b q:c="1"/><d xmlns=""/></a>', source="x")
    b, d = root.children
    assert (b.local, b.scope["p"], b.attributes["q:c"]) == ("b", "v", "1")
    assert (d.scope[""], root.scope[""]) == ("", "u")


def test_encoding_declared_in_xml_is_used_for_bytes_and_ignored_for_text() -> None:
    latin = '<?xml version="1.0" encoding="ISO-8859-1"?><a>é</a>'
    assert read_tree(latin.encode("latin-1"), source="x").text == "é"
    assert read_tree(latin, source="x").text == "é"
    assert read_tree("<a>日本</a>".encode("utf-16"), source="x").text == "日本"


def test_xml_document_with_a_doctype_declaration_is_accepted() -> None:
    assert read_tree('<!DOCTYPE a SYSTEM "elsewhere.dtd" []><a/>', source="x").name == "a"


@pytest.mark.parametrize(
    "text",
    [
        '<!DOCTYPE a [<!ENTITY e "x">]><a/>',
        '<!DOCTYPE a [<!ENTITY e "x">]><a b="&e;"/>',
        '<!DOCTYPE a [<!ENTITY e SYSTEM "file:///etc/passwd">]><a>&e;</a>',
        '<!DOCTYPE a [<!ENTITY % e "x">]><a/>',
        '<!DOCTYPE a [<!ENTITY l "ha"><!ENTITY l2 "&l;&l;&l;&l;">]><a>&l2;</a>',
        '<!DOCTYPE a SYSTEM "elsewhere.dtd"><a>&unknown;</a>',
        "<a>&unknown;</a>",
    ],
)
def test_xml_entities_are_rejected(text: str) -> None:
    with pytest.raises(BmlError, match=r"^x:1:\d+: .*; "):
        read_tree(text, source="x")


@pytest.mark.parametrize(
    "text",
    ["", b"", "  \n", "hello", "<a>", "<a></b>", '<a b="1" b="2"/>', b"\xff\xfe\x00", "<a/><b/>", "\ud800<a/>", "\x00"],
)
def test_invalid_xml_is_rejected_with_line_and_column(text: str | bytes) -> None:
    with pytest.raises(BmlError, match=r"^x:\d+:\d+: .*; "):
        read_tree(text, source="x")


@pytest.mark.parametrize("encoding", ["no-such", "utf-7", "shift_jis", "idna"])
def test_unsupported_xml_encodings_are_rejected(encoding: str) -> None:
    with pytest.raises(BmlError, match=r"^x:\d+:\d+: .*; "):
        read_tree(f'<?xml version="1.0" encoding="{encoding}"?><a>é</a>'.encode("latin-1"), source="x")


def test_size_of_an_xml_document_is_checked_before_parsing() -> None:
    with pytest.raises(BmlError, match="100000000 characters; the limit is 4000000"):
        read_tree(b"<" * 100_000_000, source="x")


def test_deeply_nested_xml_is_rejected() -> None:
    deep = "<a>" * 64 + "</a>" * 64
    assert read_tree(deep, source="x").name == "a"
    with pytest.raises(BmlError, match=r"^x:1:193: .*the limit is 64"):
        read_tree(f"{deep[:192]}<b/>{deep[192:]}", source="x")
    with pytest.raises(BmlError, match="the limit is 2"):
        read_tree("<a><a><a/></a></a>", source="x", bounds=DocumentBounds(depth=2))
