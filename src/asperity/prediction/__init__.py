"""Predictions: growth of the contact area with time, from a scan and a measured solid, with bands."""

from asperity.base.calls import answered as _answered
from asperity.contact.remarks import Resolved
from asperity.prediction import rows as rows  # defines Prediction.rows
from asperity.prediction.predicting import predict
from asperity.prediction.results import Growth, Prediction

__all__ = ["Growth", "Prediction", "Resolved", "predict"]
__dir__ = _answered(globals())
