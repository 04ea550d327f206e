"""Parameters that a measured curve determines: posteriors, verdicts, and the best next measurement."""

from asperity.base.calls import answered as _answered
from asperity.inference.figures import inference_page, inference_pictures
from asperity.inference.found import Inference
from asperity.inference.indented import IndentedSolid
from asperity.inference.indenting import Indentation, read_indentation
from asperity.inference.inferring import infer
from asperity.inference.models import Model
from asperity.inference.priors import Prior
from asperity.inference.verdicts import Candidate, Combination, Verdict

__all__ = [
    "Candidate",
    "Combination",
    "Indentation",
    "IndentedSolid",
    "Inference",
    "Model",
    "Prior",
    "Verdict",
    "infer",
    "inference_page",
    "inference_pictures",
    "read_indentation",
]
__dir__ = _answered(globals())
