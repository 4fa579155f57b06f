"""Verbs `kinesic study`: perception studies, from questionnaire pages to result tables."""
