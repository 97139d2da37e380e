"""SAPIEN's own shaders less what our pictures do not show, which is most of the time that they take on a CPU.

The pictures stay the same to the bit. Left out are:

- light from an environment map. There is none, but its table of reflections alone, which SAPIEN computes in
  every process before the first picture, takes 8 s;
- pictures of the segmentation in false colours, a fifth of the time of a picture;
- the pass for transparent surfaces. There are none.
"""

import logging
import re
import shutil
import tempfile
from pathlib import Path

import sapien

from preshape.paths import project_root
from preshape.source_digest import source_digest

log = logging.getLogger(__name__)

SHADERS = Path(sapien.__file__).with_name("vulkan_shader")
PACK, SHARED = "default", "common"
LEFT_OUT = ("gbuffer1.frag", "gbuffer1.vert")
"""The pass for transparent surfaces."""
EDITS = {
    "scene_set.glsl": ((r"layout\([^)]*\) uniform sampler2D samplerBRDFLUT;", ""),),
    "deferred.frag": (
        (r"vec3 diffuseIBL\(.*?\n}\n", ""),
        (r"vec3 specularIBL\(.*?\n}\n", ""),
        (r"color \+= diffuseIBL\(.*?;", ""),
        (r"color \+= specularIBL\(.*?;", ""),
    ),
    "composite0.frag": (
        (r"layout\(location = 2\) out vec4 outSegmentationView0;", ""),
        (r"layout\(location = 3\) out vec4 outSegmentationView1;", ""),
        (r"layout\(location = 4\) out vec4 outPosition;", "layout(location = 2) out vec4 outPosition;"),
        (r"outSegmentationView0 = .*?;", ""),
        (r"outSegmentationView1 = .*?;", ""),
    ),
}
"""For each file regular expressions and what takes the place of their only match."""


def lean_shaders() -> str:
    """Folder of the shaders for a camera, made if it is not there; that of SAPIEN's own if it cannot be."""
    name = f"{sapien.__version__}-{source_digest(__name__)[:16]}"
    folder = project_root() / ".cache" / "shaders" / name
    if not (folder / PACK).is_dir():
        try:
            _make(folder)
        except (OSError, LookupError) as error:
            log.warning("Pictures take longer, with SAPIEN's own shaders: %s", error)
            folder = SHADERS
    return str(folder / PACK)


def _make(folder: Path) -> None:
    folder.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder.parent) as unfinished:
        whole = Path(unfinished) / folder.name
        for part in (PACK, SHARED):
            shutil.copytree(SHADERS / part, whole / part)
        _edit(whole / PACK)
        try:
            whole.rename(folder)
        except OSError:
            if not folder.is_dir():  # no other process was faster
                raise


def _edit(pack: Path) -> None:
    for name, edits in EDITS.items():
        text = (pack / name).read_text(encoding="utf-8")
        for pattern, replacement in edits:
            text, count = re.subn(pattern, replacement, text, flags=re.DOTALL)
            if count != 1:
                raise LookupError(f"{name} of SAPIEN {sapien.__version__} is not as expected")
        (pack / name).write_text(text, encoding="utf-8")
    for name in LEFT_OUT:
        (pack / name).unlink()
