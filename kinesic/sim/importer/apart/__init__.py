"""Import of untrusted robot files in a separate process."""
