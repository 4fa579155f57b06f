"""Tools by which a language model performs: gestures to choose from, documents, text, gaze, and a stop."""
