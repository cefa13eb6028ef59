"""`brakewave.ball_waves` by the name that it had beside the checker."""

import sys

from brakewave import ball_waves

sys.modules[__name__] = ball_waves
