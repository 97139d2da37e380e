"""Correcting predicted probabilities by outcomes of trials that are not judged by them."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Bool, Float, Shaped
from scipy.special import expit, logit
from sklearn.isotonic import IsotonicRegression

from preshape.evaluation.calibration import fit_temperature

SUREST = 1e-9
"""Probabilities closer to 0 or 1 than this count as this close, so that their log odds are finite."""
Correction = Callable[[Float[np.ndarray, "_"]], Float[np.ndarray, "_"]]
"""Corrects probabilities."""
Fit = Callable[[Bool[np.ndarray, "n"], Float[np.ndarray, "n"]], Correction]
"""Makes a correction from labels and predicted probabilities."""


def temperature_scaling(labels: Bool[np.ndarray, "n"], success_prob: Float[np.ndarray, "n"]) -> Correction:
    """Divide log odds by one number; what is likelier than not stays so."""
    temperature = fit_temperature(labels, _log_odds(success_prob))
    return lambda prob: np.asarray(expit(_log_odds(prob) / temperature))


def isotonic_regression(labels: Bool[np.ndarray, "n"], success_prob: Float[np.ndarray, "n"]) -> Correction:
    """The best non-decreasing function of the probability; it may correct any bias, and needs more trials."""
    fitted = IsotonicRegression(y_min=0.0, y_max=1.0, out_of_bounds="clip").fit(success_prob, labels)
    return lambda prob: np.asarray(fitted.predict(prob))


def cross_fitted(
    fit: Fit,
    labels: Bool[np.ndarray, "n"],
    success_prob: Float[np.ndarray, "n"],
    part: Shaped[np.ndarray, "n"],
) -> Float[np.ndarray, "n"]:
    """Probabilities of each part of the trials, corrected by all the others.

    Args:
        fit: makes the correction.
        labels: whether each trial lifted.
        success_prob: predicted probability of it.
        part: which part each trial belongs to, such as a half or a fold; trials of one scene belong together.

    Returns:
        NaN if there is one part alone.
    """
    corrected = np.full(len(labels), np.nan)
    for own in (part == name for name in np.unique(part)):
        if not own.all():
            corrected[own] = fit(labels[~own], success_prob[~own])(success_prob[own])
    return corrected


def _log_odds(prob: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n"]:
    return np.asarray(logit(np.clip(prob, SUREST, 1 - SUREST)))
