"""Reader of untrusted robot files within limits of size and number."""
