"""Tests of the server, in a package so that shared fixtures close last."""
