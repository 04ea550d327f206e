"""Predictions: growth of the contact area with time, from a scan and a measured solid, with bands."""

from asperity.base.calls import answered as _answered
from asperity.contact.remarks import Resolved as Resolved
from asperity.prediction import rows as rows
from asperity.prediction.predicting import predict as predict
from asperity.prediction.results import Growth as Growth
from asperity.prediction.results import Prediction as Prediction

__dir__ = _answered(globals())
