import pytest

from kinesic.speech.timings.reading import read_timed_words
from kinesic.speech.timings.timed_words import TimedSpan, TimingError

ELAN_FILE = """<?xml version="1.0" encoding="UTF-8"?>
<ANNOTATION_DOCUMENT AUTHOR="" FORMAT="3.0">
  <TIME_ORDER>
    <TIME_SLOT TIME_SLOT_ID="ts1" TIME_VALUE="200"/>
    <TIME_SLOT TIME_SLOT_ID="ts2"/>
    <TIME_SLOT TIME_SLOT_ID="ts3" TIME_VALUE="1000"/>
  </TIME_ORDER>
  <TIER TIER_ID="notes" LINGUISTIC_TYPE_REF="default">
    <ANNOTATION><ALIGNABLE_ANNOTATION ANNOTATION_ID="a0" TIME_SLOT_REF1="ts1" TIME_SLOT_REF2="ts3">
      <ANNOTATION_VALUE>greeting</ANNOTATION_VALUE></ALIGNABLE_ANNOTATION></ANNOTATION>
  </TIER>
  <TIER TIER_ID="Words" LINGUISTIC_TYPE_REF="default">
    <ANNOTATION><ALIGNABLE_ANNOTATION ANNOTATION_ID="a2" TIME_SLOT_REF1="ts2" TIME_SLOT_REF2="ts3">
      <ANNOTATION_VALUE>friend &amp; co</ANNOTATION_VALUE></ALIGNABLE_ANNOTATION></ANNOTATION>
    <ANNOTATION><ALIGNABLE_ANNOTATION ANNOTATION_ID="a1" TIME_SLOT_REF1="ts1" TIME_SLOT_REF2="ts2">
      <ANNOTATION_VALUE>Hello</ANNOTATION_VALUE></ALIGNABLE_ANNOTATION></ANNOTATION>
  </TIER>
  <TIER TIER_ID="gloss" PARENT_REF="Words" LINGUISTIC_TYPE_REF="gloss">
    <ANNOTATION><REF_ANNOTATION ANNOTATION_ID="a3" ANNOTATION_REF="a1">
      <ANNOTATION_VALUE>Hallo</ANNOTATION_VALUE></REF_ANNOTATION></ANNOTATION>
  </TIER>
</ANNOTATION_DOCUMENT>
"""


def test_elan_words_tier_is_read_in_time_order_with_missing_times_interpolated():
    timed = read_timed_words(ELAN_FILE.encode())
    assert timed.words == (TimedSpan("Hello", 0.2, 0.6), TimedSpan("friend & co", 0.6, 1.0))


def test_first_elan_tier_gives_the_words_if_no_tier_is_named_words():
    assert read_timed_words(ELAN_FILE.replace('"Words"', '"x"').encode()).words == (TimedSpan("greeting", 0.2, 1.0),)


def test_speaker_suffix_of_a_tier_name_is_ignored():
    assert len(read_timed_words(ELAN_FILE.replace('"Words"', '"words@Anna"').encode()).words) == 2


# document type whose entities expand to a long text
ENTITY_BOMB = '<!DOCTYPE a [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;&a;&a;">]>'


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"200"', '"-200"', "time slot 'ts1' is -200; times are 0 to 1300000"),
        ('"200"', '"nan"', "time slot 'ts1' is nan"),
        ('"200"', '"soon"', "time slot 'ts1' is 'soon'; it must be a number"),
        ('TIME_SLOT_REF2="ts2"', 'TIME_SLOT_REF2="ts9"', "tier 'Words' annotation 2 refers to time slot 'ts9'"),
        (' TIME_VALUE="1000"', ' TIME_VALUE="100"', "ends at 0.1 s, before its start at 0.15 s"),
        ("<ANNOTATION_DOCUMENT", f"{ENTITY_BOMB}<ANNOTATION_DOCUMENT", "the XML has a document type"),
        ("ALIGNABLE_ANNOTATION", "REF_ANNOTATION", "no tier has annotations with times"),
        ("</TIER>", "", "line 22: the XML is damaged: mismatched tag"),
    ],
)
def test_invalid_elan_file_is_refused_with_the_location_of_its_fault(old: str, new: str, message: str):
    assert old in ELAN_FILE
    text = ELAN_FILE.replace(old, new)
    with pytest.raises(TimingError, match=message):
        read_timed_words(text.encode())


@pytest.mark.parametrize("length", range(100, len(ELAN_FILE) - 25, 173))
def test_truncated_elan_file_is_refused(length: int):
    with pytest.raises(TimingError, match="damaged"):
        read_timed_words(ELAN_FILE[:length].encode())
