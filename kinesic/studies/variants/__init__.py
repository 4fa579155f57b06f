"""One document, performed with many variants of the servos."""
