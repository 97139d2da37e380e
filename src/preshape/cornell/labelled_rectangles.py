"""The labelled rectangles of the data set as a table of trials, which the rest of the project learns from."""

import numpy as np

from preshape.cornell.data_set import CornellDataSet, CornellImage
from preshape.cornell.rectangle import GraspRectangle
from preshape.data.trial import Face, Trial, TrialOutcome
from preshape.data.trial_table import TableOrigin, TrialTable
from preshape.grasps.rectangle_space import theta_of
from preshape.grasps.space import GraspSpace

ORIGIN = TableOrigin("two_finger", "cornell", "cornell")
UNKNOWN = float("nan")


def rectangle_table(data: CornellDataSet, space: GraspSpace) -> TrialTable:
    """A trial for every labelled rectangle, in the order of the images, positives first.

    A positive rectangle counts as a grasp that lifted, a negative one as a grasp that missed. A scene is an
    image, by its number; an object's name is its number in the data set and its category.
    """
    trials: list[Trial] = []
    for image in data.images:
        labelled = [(own, TrialOutcome.LIFTED) for own in image.positives]
        labelled += [(own, TrialOutcome.MISSED) for own in image.negatives]
        for rectangle, outcome in labelled:
            trials.append(_trial(len(trials), image, rectangle, outcome))
    return TrialTable.from_trials(trials, space, ORIGIN)


def _trial(number: int, image: CornellImage, rectangle: GraspRectangle, outcome: TrialOutcome) -> Trial:
    theta = theta_of(rectangle)
    subject = image.subject
    return Trial(
        trial_id=number,
        scene_id=image.files.number,
        object_id=f"{subject.object_id}_{subject.category}",
        planner="label",
        face=Face.TOP,
        initial=theta,
        planned=theta,
        reached=theta,
        outcome=outcome,
        lift_height_m=UNKNOWN,
        success_prob=UNKNOWN,
        seed=0,
        scene_s=0.0,
        planning_s=0.0,
        physics_s=0.0,
        rendering_s=0.0,
        soft_label=np.nan,
    )
