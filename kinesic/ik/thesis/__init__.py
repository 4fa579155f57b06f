"""NumPy implementation of the thesis' inverse kinematics (chapter 7)."""
