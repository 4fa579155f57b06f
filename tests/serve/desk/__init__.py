"""Tests of the query service, in a package so that fixtures are shared."""
