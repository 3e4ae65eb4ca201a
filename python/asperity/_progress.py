"""A progress bar."""

from collections.abc import Callable


def bar() -> Callable[[float], None]:
    """A function that moves a progress bar of tqdm to the completed fraction, and closes it at 1."""
    try:
        from tqdm.auto import tqdm
    except ImportError as error:
        raise ImportError("progress=True needs tqdm: pip install tqdm") from error
    shown = tqdm(total=1.0, bar_format="{l_bar}{bar}| {elapsed}<{remaining}")

    def move(fraction: float) -> None:
        shown.update(fraction - shown.n)
        if fraction == 1.0:
            shown.close()

    return move
