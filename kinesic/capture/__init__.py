"""Motion files: reading, retargeting to a robot and certification."""

from importlib.util import find_spec

from kinesic.body.config import ConfigError
from kinesic.extras import install_extra

if find_spec("scipy") is None:
    raise ConfigError(f"motion files need SciPy: {install_extra('capture')}")
