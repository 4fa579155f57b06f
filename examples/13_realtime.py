"""Give a body to an OpenAI-like realtime stream: its voice becomes the robot's."""

import json

SOUND = {"do": "sound", "rate": 24_000}


def of_realtime(event):
    """Return the robot's message for a server event, or None."""
    match event:
        case {"type": "input_audio_buffer.speech_started"}:
            return {"do": "heard", "voice": True}
        case {"type": "input_audio_buffer.speech_stopped"}:
            return {"do": "heard", "voice": False}
        case {"type": "conversation.item.input_audio_transcription.completed", "transcript": text}:
            return {"do": "heard", "text": text, "final": True}
        case {"type": "response.created"}:
            return {"do": "think", "on": True}
        case {"type": "response.audio.delta" | "response.output_audio.delta", "item_id": id, "delta": data}:
            return {**SOUND, "id": id, "data": data}
        case {"type": "response.audio.done" | "response.output_audio.done", "item_id": id}:
            return {**SOUND, "id": id, "data": "", "ends": True}
    return None


def to_realtime(told):
    """Return the client event that shortens an answer to the part that was heard, or None."""
    match told:
        case {"told": "yielded", "sound": id, "at": at}:
            place = {"item_id": id, "content_index": 0, "audio_end_ms": round(1000 * at)}
            return {"type": "conversation.item.truncate", **place}
    return None


print(json.dumps(of_realtime({"type": "response.output_audio.delta", "item_id": "item_1", "delta": "AAAA"})))
print(json.dumps(to_realtime({"told": "yielded", "sound": "item_1", "at": 1.24})))
