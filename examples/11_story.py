"""A language model turns a story into a performance: any chat API of OpenAI's kind, and `kinesic serve`."""

import json
import os
import sys
from pathlib import Path
from urllib.request import Request, urlopen

from kinesic.client import PORT, Client
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.mcp.teaching import TEACHING
from kinesic.mcp.vocabulary import usual_gestures


def ask(url: str, model: str, messages: list[tuple[str, str]]) -> str:
    """What the model answers to a conversation."""
    headers = {"Content-Type": "application/json", "Authorization": f"Bearer {os.environ.get('CHAT_API_KEY', '')}"}
    said = [{"role": role, "content": content} for role, content in messages]
    body = json.dumps({"model": model, "messages": said}).encode()
    with urlopen(Request(f"{url}/chat/completions", body, headers), timeout=120) as reply:
        return json.load(reply)["choices"][0]["message"]["content"]


def perform_story(url: str, model: str, story: str, port: str = str(PORT)) -> None:
    """Has a model write a performance, and mend it where it is refused."""
    taught = f"{TEACHING}\nGestures that are used most: {usual_gestures(Lexicon.load())}."
    messages = [("system", taught), ("user", f"Perform this story by one JSON object:\n{Path(story).read_text()}")]
    with Client(port=int(port)) as robot:
        for _ in range(3):
            answer = ask(url, model, messages)
            *_, last = robot.perform(answer[answer.find("{") : answer.rfind("}") + 1])
            print(last)
            if "PARSING_FAILURE" not in last:
                break
            messages += [("assistant", answer), ("user", f"Mend it: {last}")]


print("skipped: give URL MODEL STORY.txt") if len(sys.argv) < 4 else perform_story(*sys.argv[1:])
