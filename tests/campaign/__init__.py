"""Campaign of random blocks, judged by independent code.

It counts violations of limits, penetrations and exceptions.
"""
