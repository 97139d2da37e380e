"""SAPIEN's own shaders less what our pictures do not show, which is most of the time that they take on a CPU.

The pictures stay the same to the bit. Left out are:

- light from an environment map. There is none, but its table of reflections alone, which SAPIEN computes in
  every process before the first picture, takes 8 s;
- pictures of the segmentation in false colours, a fifth of the time of a picture;
- the passes for transparent surfaces, lines and points, and pictures of coordinates. There are none;
- most reading of the shadow map. The 25 samples of its filter read four texels each, of only 36 in all.
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
LEFT_OUT = tuple(f"{name}.{kind}" for name in ("gbuffer1", "line", "point") for kind in ("frag", "vert"))
"""The passes for transparent surfaces, lines and points."""
SHADOW_FILTER = """
  float lit[6][6];
  for (int v = 0; v < 6; v += 2) {
    for (int u = 0; u < 6; u += 2) {
      vec4 texels = textureGather(shadowTex, projCoord.xy + filterSize * vec2(u - 2, v - 2) * searchUV);
      lit[v + 1][u] = texels.x < projCoord.z ? 0.0f : 1.0f;
      lit[v + 1][u + 1] = texels.y < projCoord.z ? 0.0f : 1.0f;
      lit[v][u + 1] = texels.z < projCoord.z ? 0.0f : 1.0f;
      lit[v][u] = texels.w < projCoord.z ? 0.0f : 1.0f;
    }
  }
  // Close to where a texel begins each sample's rounding decides which one it reads.
  bool rounds = any(greaterThan(abs(grad - 0.5f), vec2(0.5f - 2.5e-7f * resolution)));
  for (int k = 0; k < 25 && !rounds; k++) {
    int v = k / 5, u = k % 5;
    vec2 row = mix(vec2(lit[v][u], lit[v + 1][u]), vec2(lit[v][u + 1], lit[v + 1][u + 1]), grad.x);
    shadow += mix(row.x, row.y, grad.y);
  }
  int count = rounds ? PCF_SampleCount : 0;
  for (int i = 0; i < count; i++)
"""
"""The shadow filter's samples from texels that are read once; where that may differ, its own loop follows."""
EDITS = {
    f"{SHARED}/shadow.glsl": ((r"for \(int i = 0; i < PCF_SampleCount; i\+\+\)", SHADOW_FILTER),),
    f"{PACK}/scene_set.glsl": ((r"layout\([^)]*\) uniform sampler2D samplerBRDFLUT;", ""),),
    f"{PACK}/gbuffer.frag": (
        (r"layout\(location = 5\) out vec4 outCustom;", ""),
        (r"layout\(location = 6\) out vec4 outEmission;", "layout(location = 5) out vec4 outEmission;"),
        (r"outCustom = .*?;", ""),
    ),
    f"{PACK}/deferred.frag": (
        (r"layout\([^)]*\) uniform sampler2D samplerCustom;", ""),
        (r"vec3 diffuseIBL\(.*?\n}\n", ""),
        (r"vec3 specularIBL\(.*?\n}\n", ""),
        (r"color \+= diffuseIBL\(.*?;", ""),
        (r"color \+= specularIBL\(.*?;", ""),
    ),
    f"{PACK}/composite0.frag": (
        (r"layout\([^)]*\) uniform sampler2D samplerLineDepth;.*?samplerPoint;", ""),
        (r"binding = 7", "binding = 3"),
        (r"vec4 lineColor = .*?(?=outPosition =)", ""),
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
        _edit(whole)
        try:
            whole.rename(folder)
        except OSError:
            if not folder.is_dir():  # no other process was faster
                raise


def _edit(folder: Path) -> None:
    for name, edits in EDITS.items():
        text = (folder / name).read_text(encoding="utf-8")
        for pattern, replacement in edits:
            text, count = re.subn(pattern, replacement, text, flags=re.DOTALL)
            if count != 1:
                raise LookupError(f"{name} of SAPIEN {sapien.__version__} is not as expected")
        (folder / name).write_text(text, encoding="utf-8")
    for name in LEFT_OUT:
        (folder / PACK / name).unlink()
