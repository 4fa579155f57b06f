"""Incremental reader of everyday text with markup.

The result does not depend on where the text is cut: a construct is read as soon as no further text can change it.
"""

import re
from dataclasses import replace

from kinesic.intent.manuscript.inline import read_inline
from kinesic.intent.manuscript.lines import end_line, find_speakers, read_line_start, skip_other_speaker
from kinesic.intent.manuscript.pieces import Manuscript, Step
from kinesic.intent.manuscript.subtitles import read_more_subtitles, read_subtitles

CHUNK_LENGTH = 2048  # [characters] read at once, so that long texts take time in proportion to their length
KEPT_CHARACTERS = 90  # [characters] end of the spoken text that is kept as context of later markup
MAX_FENCE_LENGTH = 200  # [characters] longest incomplete line that may close a code block
_TAG_PATTERN = re.compile(r"<[^<>]*>")
_UNUSUAL_SPACES = str.maketrans({"\xa0": " ", "\u2028": "\n", "\u2029": "\n", "\ufeff": None})


def read_manuscript(text: str, *, character: str = "") -> tuple[str, tuple[str, ...]]:
    """Convert a whole text to spoken text with tags, and warnings.

    Args:
        text: as people write it.
        character: speaker of a dialogue whose lines are spoken; empty: all.

    Returns:
        Spoken text, with tags for emphasis, pauses and directions, and a warning for each part that is not spoken.
    """
    speakers = find_speakers(read_subtitles(text))
    return read_more(Manuscript(speakers=speakers, character=character.upper()), text, ends=True)[1:]


def read_more(state: Manuscript, text: str, *, ends: bool = False) -> tuple[Manuscript, str, tuple[str, ...]]:
    """Convert the next part of a text to spoken text and warnings.

    Args:
        state: after the text before it.
        text: part, cut anywhere.
        ends: whether the text ends with it.

    Returns:
        State, spoken text and warnings, as of `read_manuscript`.
    """
    spoken, warnings = list[str](), list[str]()
    for begin in range(0, max(len(text), 1), CHUNK_LENGTH):
        chunk = text[begin : begin + CHUNK_LENGTH].translate(_UNUSUAL_SPACES)
        is_last = begin + CHUNK_LENGTH >= len(text)
        subtitles, kept = read_more_subtitles(state.subtitles, chunk, ends=ends and is_last)
        state = replace(state, rest=state.rest + kept, subtitles=subtitles)
        while state.rest:
            step = _read_step(state, ends=ends and is_last)
            if step is None:
                break
            spoken.append(step.text)
            if step.warning:
                warnings.append(step.warning)
            state = _advance(state, step)
    if ends:
        if state.mode in ("thought", "skipped"):
            warnings.append(f"{state.closing} is missing: nothing after the opening tag is spoken")
        state = state.restarted()
    return state, "".join(spoken), tuple(warnings)


def _read_step(state: Manuscript, *, ends: bool) -> Step | None:
    if state.mode == "code":
        return _read_fenced(state, ends=ends)
    if state.mode == "other":
        return skip_other_speaker(state, ends=ends)
    if state.mode != "text":
        return _read_hidden(state, ends=ends)
    if state.rest[0] == "\n":
        return end_line(state, ends=ends)
    if state.is_line_start:
        step = read_line_start(state, ends=ends)
        if step is None or step.length:
            return step
    return read_inline(state, ends=ends)


def _advance(state: Manuscript, step: Step) -> Manuscript:
    """Return the reader's state after one word or markup."""
    taken = state.rest[: step.length]
    visible = _TAG_PATTERN.sub(" " if "kinesic:" not in step.text else "", step.text)
    is_over = "\n" in taken and state.mode == "text"
    is_marker = state.is_line_start and not visible.strip() and not is_over
    is_new_line = is_over or (state.is_line_start and (is_marker or state.mode != "text"))
    return Manuscript(  # `replace` takes three times as long
        rest=state.rest[step.length :],
        mode=step.mode,
        closing=step.closing,
        speakers=state.speakers,
        character=state.character,
        others=state.others | {step.other} if step.other else state.others,
        is_line_start=is_new_line or step.text.endswith("\n"),
        line_length=0 if is_over else state.line_length + len(taken),
        is_block=False if is_over else state.is_block or step.is_block,
        stress="" if is_over else state.stress if step.stress is None else step.stress,
        spoken=(state.spoken + visible)[-KEPT_CHARACTERS:],
        subtitles=state.subtitles,
    )


def _read_hidden(state: Manuscript, *, ends: bool) -> Step | None:
    """Skip text up to the end of a hidden element."""
    at = state.rest.lower().find(state.closing.lower())
    if at >= 0:
        return Step(at + len(state.closing), "")
    kept = 0 if ends else len(state.closing) - 1
    length = max(len(state.rest) - kept, 0)
    return Step(length, mode=state.mode, closing=state.closing) if length else None


def _read_fenced(state: Manuscript, *, ends: bool) -> Step | None:
    """Skip one line of a code block."""
    line, newline, _ = state.rest.partition("\n")
    if not newline and not ends:
        length = len(line) - MAX_FENCE_LENGTH
        return Step(length, mode="code", closing=state.closing) if length > 0 else None
    sign = state.closing[0]
    is_end = bool(re.fullmatch(rf"[ \t]*{re.escape(sign)}{{{len(state.closing)},}}[ \t]*", line))
    if is_end:
        return Step(len(line), "", is_block=True)
    return Step(len(line) + len(newline), mode="code", closing=state.closing)
