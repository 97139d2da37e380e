"""Names of the folders of a sweep, the same whenever it is started again."""

import hashlib
import re
from collections.abc import Sequence

NAMED_ELSEWHERE = (
    *("run_name", "experiment", "split", "fold", "hydra", "paths", "tracking"),
    "retrain_after_code_changes",
)
"""Groups of overrides that do not tell groups apart, or that the names tell already."""
PLACES = ("dataset.root",)
"""Single overrides of that kind: where things lie."""
LONGEST = 80


def sweep_group(run_name: str, overrides: Sequence[str]) -> str:
    """Name of the group that a job of a sweep belongs to: those with the same settings but split and fold.

    It is the run's name and whatever else was chosen: `config_cnn,trials=500`. The model is not named again,
    because the name of a run has it, unless that was chosen too. Long names end in a digest.

    Args:
        run_name: name of the run.
        overrides: what was chosen for this job, such as `model=config_cnn`, `fold=3`.
    """
    chosen = dict(override.lstrip("+~").partition("=")[::2] for override in sorted(overrides))
    if "run_name" not in chosen:
        chosen.pop("model", None)  # but not model.members=1, which is another network of the same name
    rest = {
        key: value
        for key, value in chosen.items()
        if key not in PLACES and re.split(r"[.@/]", key)[0] not in NAMED_ELSEWHERE
    }
    parts = [run_name, *(f"{key.rpartition('.')[2]}={value}" for key, value in rest.items())]
    name = re.sub(r"[^\w.=,+-]", "-", ",".join(parts))
    if len(name) <= LONGEST and len({key.rpartition(".")[2] for key in rest}) == len(rest):
        return name
    return f"{run_name},{hashlib.sha256(repr(rest).encode()).hexdigest()[:8]}"
