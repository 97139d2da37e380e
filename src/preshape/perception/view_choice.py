"""Which saved view the user means."""

from pathlib import Path

from preshape.errors import InputError
from preshape.perception.observation import Observation
from preshape.perception.view_files import CAMERA_NAME, DEPTH_NAME, RGB_NAME, load_view

Chosen = str | Path | None


def load_chosen_view(
    view: Chosen = None, rgb_file: Chosen = None, depth_file: Chosen = None, camera_file: Chosen = None
) -> Observation:
    """Read a view from its folder, or from three files that may lie anywhere.

    Args:
        view: folder with `rgb.png`, `depth.png` and `camera.json`.
        rgb_file, depth_file, camera_file: single files; each replaces that of the folder.

    Raises:
        InputError: if a file is not named, or the view cannot be used (see `load_view`).
    """
    if view is not None and not Path(view).is_dir():
        raise InputError(
            "The folder of the view does not exist",
            where=view,
            fix=f"give a folder with {RGB_NAME}, {DEPTH_NAME} and {CAMERA_NAME}",
        )
    files = {
        "rgb_file": _file(view, rgb_file, RGB_NAME),
        "depth_file": _file(view, depth_file, DEPTH_NAME),
        "camera_file": _file(view, camera_file, CAMERA_NAME),
    }
    missing = [key for key, file in files.items() if file is None]
    if missing:
        raise InputError(
            "No view was given" if len(missing) == len(files) else "The view is not complete",
            where=f"{', '.join(missing)} not set",
            fix=f"add view=DIR (with {RGB_NAME}, {DEPTH_NAME}, {CAMERA_NAME}), or name all three files",
        )
    return load_view(*(file for file in files.values() if file is not None))


def _file(view: Chosen, chosen: Chosen, name: str) -> Path | None:
    if chosen is not None:
        return Path(chosen)
    return None if view is None else Path(view) / name
