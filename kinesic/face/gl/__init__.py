"""The few calls of OpenGL that drawing needs, through ctypes: no library but the driver, on any processor."""
