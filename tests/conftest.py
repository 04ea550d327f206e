"""Property tests draw the same examples every time: more in the slow suite, others where it is asked for."""

import os

from hypothesis import settings

settings.register_profile("same", derandomize=True)
settings.register_profile("more", derandomize=True, max_examples=500)
settings.register_profile("other", derandomize=False, max_examples=500)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "same"))
