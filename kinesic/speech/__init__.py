"""Says the text and tells when each mark, word and phoneme falls."""
