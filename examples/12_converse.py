"""Translate events of voice stacks and trackers into a robot's conversation messages."""

import json
import sys

from kinesic.client import DEFAULT_PORT, Client

REALTIME = {  # server events of an OpenAI-like realtime stream
    "input_audio_buffer.speech_started": {"do": "heard", "voice": True},
    "input_audio_buffer.speech_stopped": {"do": "heard", "voice": False},
    "response.created": {"do": "think", "on": True},
    "response.done": {"do": "think", "on": False},
}
PIPECAT = {  # names of Pipecat frames
    "UserStartedSpeakingFrame": {"do": "heard", "voice": True},
    "UserStoppedSpeakingFrame": {"do": "heard", "voice": False},
    "LLMFullResponseStartFrame": {"do": "think", "on": True},
    "InterruptionFrame": {"do": "interrupt", "yield": True},
}


def of_ros4hri(positions):
    """Return a `people` message for faces {id: (x, y, z) [m] from the robot's base}."""
    return {"do": "people", "people": [{"id": id, "at": place, "looks": True} for id, place in positions.items()]}


messages = [
    {"do": "converse"},
    of_ros4hri({"anonymous_person_1": (1.4, 0.3, 1.6)}),
    REALTIME["input_audio_buffer.speech_started"],
    PIPECAT["UserStoppedSpeakingFrame"],
    REALTIME["response.created"],
]
print(*map(json.dumps, messages), sep="\n")
if len(sys.argv) > 1:
    with Client(port=int(sys.argv[1]) or DEFAULT_PORT) as robot:
        for message in messages:
            robot.do(message.pop("do"), **message)
        print(robot.receive(timeout=1.0))
