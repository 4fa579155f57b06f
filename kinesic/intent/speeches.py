"""Division of a long text into speeches at paragraph and sentence ends."""

from kinesic.intent.reading.passage import PHRASE_PAUSE, SENTENCE_PAUSE, Passage, is_phrase_start

MIN_PARAGRAPH_PAUSE = 0.2  # [s] shortest silence before a word that begins a paragraph
SHORT_SPEECH = 60  # [words] a shorter speech continues in the next paragraph
FULL_SPEECH = 120  # [words] length from which a speech ends with its sentence
LONGEST_SPEECH = 180  # [words] length from which a speech ends with its phrase; from twice this length, anywhere
UNDIVIDED_TEXT = 240  # [words] length up to which a text is a single speech


def divide_speech(passage: Passage) -> list[range]:
    """Divide the words of a passage into speeches.

    A voice synthesises one speech at once, and the search for its phonemes takes time with its length.
    """
    words = passage.words
    if len(words) <= UNDIVIDED_TEXT:
        return [range(len(words))]
    starts = [0]
    for k in range(1, len(words)):
        length = k - starts[-1]
        is_sentence = words[k].sentence != words[k - 1].sentence
        is_paragraph = is_sentence and words[k].pause >= MIN_PARAGRAPH_PAUSE
        is_phrase = words[k].phrase != words[k - 1].phrase
        if (
            (is_paragraph and length >= SHORT_SPEECH)
            or (is_sentence and length >= FULL_SPEECH)
            or (is_phrase and length >= LONGEST_SPEECH)
            or length >= 2 * LONGEST_SPEECH
        ):
            starts.append(k)
    return [range(start, end) for start, end in zip(starts, [*starts[1:], len(words)], strict=True)]


def gap_before(passage: Passage, index: int) -> float:
    """Return the silence [s] before a later speech's first word."""
    words = passage.words
    if words[index].sentence != words[index - 1].sentence:
        return SENTENCE_PAUSE + words[index].pause
    return (PHRASE_PAUSE if is_phrase_start(words[index]) else 0.0) + words[index].pause
