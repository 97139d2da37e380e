"""One self-contained HTML page that shows what was learned, planned and lifted."""

from dataclasses import dataclass
from pathlib import Path

from analysis.evaluation_folder import read_evaluation
from analysis.pages.page_template import page_template
from analysis.pages.scene_section import scene_section
from analysis.training_metrics import read_training_metrics
from preshape.errors import InputError
from preshape.files import atomic_path
from preshape.grasps.space import GraspSpace
from preshape.hands.kinematics import HandKinematics
from preshape.progress import Progress


@dataclass(frozen=True, eq=False)
class DemoPage:
    """The page of an evaluation.

    Args:
        evaluation: folder that `sim/evaluate.py` wrote.
        metrics: `metrics.json` of the network's training; None to leave its figures out.
        output: the page.
        climber: planner whose climb is shown.
        max_scenes: scenes shown at most, from the first; figures count all.
        space, hand: what theta means, and what is drawn at it.
    """

    evaluation: str
    metrics: str | None
    output: str
    climber: str
    max_scenes: int
    space: GraspSpace
    hand: HandKinematics

    def write(self) -> str:
        """Write the page and say what came out.

        Raises:
            InputError: if the evaluation or the metrics cannot be used, or the page cannot be written.
        """
        evaluation = read_evaluation(self.evaluation, self.space)
        if self.climber not in evaluation.planners:
            raise InputError(
                f"{self.climber} took no part in the evaluation, so there is no climb to show",
                where=self.evaluation,
                fix=f"choose one of its planners with report.climber: {', '.join(evaluation.planners)}",
            )
        metrics = None if self.metrics is None else read_training_metrics(self.metrics)
        scenes = evaluation.scenes.scenes[: self.max_scenes]
        sections = []
        with Progress("Drawing", len(scenes), "scenes") as progress:
            for scene in scenes:
                sections.append(scene_section(evaluation, scene, self.climber, self.hand))
                progress.advance()
        page = page_template("demo.html").render(
            summary=evaluation.summary,
            planners=evaluation.planners,
            origin=evaluation.trials.origin,
            scene_count=len(evaluation.scenes),
            climber=self.climber,
            metrics=metrics,
            sections=sections,
        )
        with atomic_path(self.output) as temporary:
            temporary.write_text(page, encoding="utf-8")
        return f"Lifted: {evaluation.lifted}. Page: {Path(self.output)}"
