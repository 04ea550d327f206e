"""Parameters that a measured curve determines: posteriors, verdicts, and the best next measurement."""

from asperity.base.calls import answered as _answered
from asperity.inference.figures import inference_page as inference_page
from asperity.inference.figures import inference_pictures as inference_pictures
from asperity.inference.found import Inference as Inference
from asperity.inference.indented import IndentedSolid as IndentedSolid
from asperity.inference.indenting import Indentation as Indentation
from asperity.inference.indenting import read_indentation as read_indentation
from asperity.inference.inferring import infer as infer
from asperity.inference.models import Model as Model
from asperity.inference.priors import Prior as Prior
from asperity.inference.verdicts import Candidate as Candidate
from asperity.inference.verdicts import Combination as Combination
from asperity.inference.verdicts import Verdict as Verdict

__dir__ = _answered(globals())
