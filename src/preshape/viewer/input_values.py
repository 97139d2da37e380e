"""Setting what the inputs of the viewer's panel show."""

from typing import Any


def set_value(handle: Any, value: Any) -> None:
    """Set an input; whoever listens to it is told, as if the user had done it.

    Args:
        handle: of a checkbox, slider or dropdown. Viser's classes say so, but not in a way that mypy follows.
        value: of the input's own type.
    """
    handle.value = value
