"""Turns gestures into keys of the hands: strokes, holds, and what happens between gestures."""
