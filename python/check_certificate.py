"""The checker by the name and the place that it had: it is `python -m brakewave.check DIR`."""

import sys

import brakewave.check as check

if __name__ == "__main__":
    sys.exit(check.command(sys.argv))
sys.modules[__name__] = check
