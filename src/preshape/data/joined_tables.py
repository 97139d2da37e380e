"""Data sets put one after the other."""

from dataclasses import replace

import numpy as np
import pandas as pd

from preshape.data.trial_table import THETAS, SceneTable, TrialTable

DataSet = tuple[SceneTable, TrialTable]


def joined(first: DataSet, second: DataSet) -> DataSet:
    """Both data sets as one; scenes and trials of the second get the numbers after those of the first.

    Args:
        first, second: scenes and trials, collected with the same robot, objects and camera.
    """
    (scenes, trials), (more_scenes, more_trials) = first, second
    scene_offset = 1 + max((scene.scene_id for scene in scenes.scenes), default=-1)
    trial_offset = 1 + max(trials.rows["trial_id"], default=-1)
    moved = tuple(replace(scene, scene_id=scene.scene_id + scene_offset) for scene in more_scenes.scenes)
    more_rows = more_trials.rows.assign(
        trial_id=more_trials.rows["trial_id"] + trial_offset,
        scene_id=more_trials.rows["scene_id"] + scene_offset,
    )
    rows = pd.concat([trials.rows, more_rows], ignore_index=True)
    thetas = (np.concatenate((getattr(trials, name), getattr(more_trials, name))) for name in THETAS)
    return SceneTable(scenes.origin, scenes.scenes + moved), TrialTable(
        trials.origin, trials.space, rows, *thetas
    )
