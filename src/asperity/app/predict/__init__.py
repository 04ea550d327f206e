"""Predictions from the configuration of a run, in files and words."""

from asperity.app.predict.pipeline import predict_config

__all__ = ["predict_config"]
