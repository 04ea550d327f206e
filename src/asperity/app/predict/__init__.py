"""Predictions: from a relaxation table or a solid, a scan and a load to the growth of the real contact."""

from asperity.app.predict.pipeline import predict, predict_config
from asperity.base.calls import answered as _answered

__all__ = ["predict", "predict_config"]
__dir__ = _answered(globals())
