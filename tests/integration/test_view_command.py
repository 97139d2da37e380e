"""`python src/view.py`: shows a saved view without the simulator, and ends with Ctrl-C."""

import signal
import subprocess
import sys
import urllib.request
from pathlib import Path

from synthetic_scenes import BoxRenderer, make_scene

from preshape.perception.view_files import save_view

VIEW = Path(__file__).parents[2] / "src" / "view.py"
# As on a machine on which SAPIEN and the arm's planners cannot be imported.
WITHOUT_SIMULATOR = (
    "import runpy, sys; sys.modules |= {'sapien': None, 'ompl': None, 'toppra': None};"
    f"sys.argv[0] = {str(VIEW)!r}; runpy.run_path(sys.argv[0], run_name='__main__')"
)


def start(folder: Path, *overrides: str) -> subprocess.Popen[str]:
    settings = (f"paths.outputs={folder / 'runs'}", f"paths.cache={folder / 'cache'}", "port=0")
    command = [sys.executable, "-c", WITHOUT_SIMULATOR, *settings, *overrides]
    return subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def test_a_saved_view_is_shown_until_ctrl_c(tmp_path: Path) -> None:
    save_view(tmp_path / "view", BoxRenderer()(make_scene(0)))
    viewer = start(tmp_path, "view=view", "planner.method.max_iterations=2")
    assert viewer.stdout is not None
    lines = []
    while "Viewer: " not in (line := viewer.stdout.readline()):
        lines.append(line)
        assert line, "".join(lines)
    url = line.split("Viewer: ")[1].split()[0]
    assert url.startswith("http://127.0.0.1:")
    with urllib.request.urlopen(url, timeout=60) as page:  # noqa: S310 - it begins with http
        assert page.status == 200
    viewer.send_signal(signal.SIGINT)
    rest = viewer.communicate(timeout=60)[0]
    assert viewer.returncode == 0, rest
    assert "Traceback" not in rest
    assert rest.splitlines()[-1].endswith("The viewer has ended")
