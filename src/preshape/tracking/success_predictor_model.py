"""What MLflow runs to load a logged network; a copy of it lies in the folder of the model."""

from mlflow.models import set_model

from preshape.tracking.success_predictor import SuccessPredictor

set_model(SuccessPredictor())
