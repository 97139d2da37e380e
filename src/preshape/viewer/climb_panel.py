"""The climb of a planner, with a slider along it."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float64
from viser import GuiApi

from preshape.planning.grasp_plan import GraspPlan
from preshape.planning.result import PlanStatus
from preshape.viewer.input_values import set_value
from preshape.viewer.job_queue import JobQueue
from preshape.viewer.line_plot import Line, LinePlot

WHY_STOPPED = {
    PlanStatus.CONVERGED: "nothing more to gain",
    PlanStatus.AT_BOUNDS: "nothing more to gain within its bounds",
    PlanStatus.ITERATION_LIMIT: "its iterations were used up",
    PlanStatus.NO_ASCENT: "no higher point was found along the gradient",
    PlanStatus.NOT_OPTIMIZED: "this planner does not climb",
    PlanStatus.INFEASIBLE: "no allowed grasp was found within its bounds",
}
NO_PLAN = "Nothing is planned yet."


class ClimbPanel:
    """Chooses one of a plan's starts and a step of its climb.

    Args:
        gui: the viewer's panel.
        jobs: does what the browser asks for.
        moved: what is to be done when another grasp is chosen.
        from_the_end: whether a new plan is first shown at the end of its climb, or at its beginning.
        without: what is said as long as there is no plan.
    """

    def __init__(
        self,
        gui: GuiApi,
        jobs: JobQueue,
        moved: Callable[[], None],
        *,
        from_the_end: bool,
        without: str = NO_PLAN,
    ) -> None:
        self._plan: GraspPlan | None = None
        self._shown: int | None = None
        self._moved, self._from_the_end, self._without = moved, from_the_end, without
        self._text = gui.add_markdown(without)
        self.start = gui.add_dropdown("grasp", ("-",), disabled=True)
        self.step = gui.add_slider("step", min=0, max=1, step=1, initial_value=0, disabled=True)
        self.plot = LinePlot(gui, "step", [Line("p(success)", "#005ab5")], (-0.02, 1.05))
        self.start.on_update(lambda _: jobs.put(self._show_start))
        self.step.on_update(lambda _: jobs.put(self._show_step))

    def show(self, plan: GraspPlan | None) -> None:
        """Show a plan, its best grasp first; None for no plan."""
        self._plan, self._shown = plan, None
        self.start.disabled = plan is None or len(plan.faces) == 1
        if plan is None:
            self._text.content = self._without
            self.step.disabled = True
            return
        self.start.options = tuple(self._names())
        set_value(self.start, self._names()[0])
        self._show_start()

    @property
    def theta(self) -> Float64[np.ndarray, "d"] | None:
        """The chosen grasp of the climb; None without a plan."""
        return None if self._plan is None else self._plan.result.path[self._row][self.step.value]

    @property
    def initial(self) -> Float64[np.ndarray, "d"] | None:
        """Where the chosen climb begins; None without a plan."""
        return None if self._plan is None else self._plan.result.path[self._row][0]

    @property
    def success_prob(self) -> float:
        """The success probability of the chosen grasp; NaN without a plan or a network."""
        return float("nan") if self._plan is None else self._plan.result.climb[self._row][self.step.value]

    @property
    def _row(self) -> int:
        assert self._plan is not None
        return int(self._plan.result.ranking[self._names().index(self.start.value)])

    def _names(self) -> list[str]:
        """The starts, the best first: rank and face."""
        assert self._plan is not None
        ranked = enumerate(self._plan.result.ranking.tolist(), 1)
        return [f"{rank}. {self._plan.faces[row].value.replace('_', ' ')}" for rank, row in ranked]

    def _show_start(self) -> None:
        """Show another climb; what is set here counts as chosen, too, and must not begin it again."""
        if self._plan is None or self._shown == self._row:
            return
        self._shown = self._row
        climb = np.array(self._plan.result.climb[self._row])
        last = len(climb) - 1
        # A slider without length cannot be drawn; it is disabled then.
        self.step.disabled = last == 0
        set_value(self.step, 0)
        self.step.max = max(1, last)
        self.plot.show(np.arange(len(climb), dtype=np.float64), climb[None])
        set_value(self.step, last if self._from_the_end else 0)
        self._show_step()

    def _show_step(self) -> None:
        if self._plan is None:
            return
        self.plot.mark(self.step.value)
        self._text.content = self._words()
        self._moved()

    def _words(self) -> str:
        assert self._plan is not None
        result, row = self._plan.result, self._row
        climb, status = result.climb[row], result.status[row]
        if np.isnan(climb[0]):
            return "Without a network, nothing is known about success. Give weights=FILE."
        where = f"step {self.step.value} of {len(climb) - 1}"
        course = f"{climb[0]:.3f} at first, {climb[-1]:.3f} in the end: {WHY_STOPPED[status]}."
        beyond_mm = 1000 * result.violation_m[row]
        allowed = f" The planned hand is {beyond_mm:.0f} mm from where it may be." if beyond_mm > 0 else ""
        return f"## p(success) = {self.success_prob:.3f}\n{where}\n\n{course}{allowed}"
