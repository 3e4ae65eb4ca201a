"""Pictures are drawn without a screen."""

import os

os.environ["MPLBACKEND"] = "agg"
