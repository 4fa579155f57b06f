"""The files of Greta that say how intentions are shown: lexicons of intentions, baselines and qualifiers."""
