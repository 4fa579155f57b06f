"""Speech synthesis with the time of each mark, word and phoneme."""
