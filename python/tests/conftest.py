"""Pictures are drawn without a screen, and closed after each test."""

import os
import sys
from collections.abc import Iterator

import pytest

os.environ["MPLBACKEND"] = "agg"


@pytest.fixture(autouse=True)
def closed_pictures() -> Iterator[None]:
    """Matplotlib warns of more than twenty open figures, and warnings are errors."""
    yield
    if pyplot := sys.modules.get("matplotlib.pyplot"):
        pyplot.close("all")
