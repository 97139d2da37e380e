"""The learning rate of a cycle."""

import pytest
import torch

from preshape.models.one_cycle import one_cycle


@pytest.mark.parametrize("steps", [1, 2, 3, 10, 11, 15, 2001])
def test_the_rate_rises_to_the_highest_and_falls_to_nearly_nothing(steps: int) -> None:
    optimizer = torch.optim.AdamW([torch.nn.Parameter(torch.zeros(1))], 1e-3)
    cycle = one_cycle(optimizer, 1e-3, steps)
    rates = [optimizer.param_groups[0]["lr"]]
    for _ in range(steps - 1):
        optimizer.step()
        cycle.step()
        rates.append(optimizer.param_groups[0]["lr"])
    peak = rates.index(max(rates))
    assert max(rates) <= 1e-3 * (1 + 1e-9)
    assert rates[: peak + 1] == sorted(rates[: peak + 1])
    assert rates[peak:] == sorted(rates[peak:], reverse=True)
    if steps > 3:
        assert rates[-1] < 1e-6 < max(rates)
