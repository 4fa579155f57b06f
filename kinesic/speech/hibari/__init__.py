"""Neural voice: the model of the package hibari-tts, with phoneme times and pitch."""
