"""Neural voice hibari, with phoneme times and pitch."""
