"""`brakewave.ball_spectrum` by the name that it had beside the checker."""

import sys

from brakewave import ball_spectrum

sys.modules[__name__] = ball_spectrum
