"""Common parts of the studies: a questionnaire page and files of answers."""
