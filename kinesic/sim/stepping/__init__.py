"""Physics steps of the twin and the log of each step."""
