"""Let a language model write a performance of a story for `kinesic serve`."""

import json
import os
import sys
from pathlib import Path
from urllib.request import Request, urlopen

from kinesic.client import DEFAULT_PORT, Client
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.mcp.teaching import MODEL_INSTRUCTIONS
from kinesic.mcp.vocabulary import common_gestures


def ask(url: str, model: str, messages: list[tuple[str, str]]) -> str:
    """Return the model's answer to a conversation."""
    headers = {"Content-Type": "application/json", "Authorization": f"Bearer {os.environ.get('CHAT_API_KEY', '')}"}
    chat = [{"role": role, "content": content} for role, content in messages]
    body = json.dumps({"model": model, "messages": chat}).encode()
    with urlopen(Request(f"{url}/chat/completions", body, headers), timeout=120) as reply:
        return json.load(reply)["choices"][0]["message"]["content"]


def perform_story(url: str, model: str, story: str, port: str = str(DEFAULT_PORT)) -> None:
    """Let a model write a performance, and repair it if it is refused."""
    system = f"{MODEL_INSTRUCTIONS}\nMost frequent gestures: {common_gestures(Lexicon.load())}."
    messages = [("system", system), ("user", f"Perform this story as one JSON object:\n{Path(story).read_text()}")]
    with Client(port=int(port)) as robot:
        for _ in range(3):
            answer = ask(url, model, messages)
            *_, last = robot.perform(answer[answer.find("{") : answer.rfind("}") + 1])
            print(last)
            if "PARSING_FAILURE" not in last:
                break
            messages += [("assistant", answer), ("user", f"Correct it: {last}")]


print("skipped: give URL MODEL STORY.txt") if len(sys.argv) < 4 else perform_story(*sys.argv[1:])
