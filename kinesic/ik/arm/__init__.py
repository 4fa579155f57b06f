"""Inverse kinematics of one arm: shoulder, elbow and wrist."""
