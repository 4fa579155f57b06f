"""Search for better robot designs by trials in the twin.

Variants of a robot file, their evaluation and Pareto front.
"""
