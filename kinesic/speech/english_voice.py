"""Voice that speaks English with one engine and other languages with another."""

from dataclasses import dataclass, replace

from kinesic.body.utterance import Script, Utterance, Voice

AMERICAN_TAGS = frozenset({"", "en", "en-us"})  # language tags spoken with an American accent


@dataclass(frozen=True)
class EnglishVoice:
    """Voice of American English, with a substitute for other accents and languages."""

    english: Voice
    other: Voice
    is_requested: bool = False  # whether the user chose `english`, which then also speaks other accents of English

    def say(self, script: Script, /, *, rate: float = 1.0, pitch: float = 1.0) -> Utterance:
        """Speak a script with the voice of its language."""
        tag = script.language.strip().replace("_", "-").lower()
        if tag in AMERICAN_TAGS:
            return self.english.say(script, rate=rate, pitch=pitch)
        if not self.is_requested:
            return self.other.say(script, rate=rate, pitch=pitch)
        if tag.startswith("en-"):
            utterance = self.english.say(script, rate=rate, pitch=pitch)
            remark = f"{utterance.voice} has an American accent: {script.language!r} is spoken with it"
        else:
            utterance = self.other.say(script, rate=rate, pitch=pitch)
            remark = f"hibari speaks English alone: {utterance.voice} speaks {script.language!r}"
        return replace(utterance, remarks=(remark, *utterance.remarks))
