from kinesic._kernel import controller as controller
from kinesic._kernel import ik as ik
from kinesic._kernel import metrics as metrics
from kinesic._kernel import motion as motion
from kinesic._kernel import sim as sim
