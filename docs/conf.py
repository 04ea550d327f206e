"""How the pages are made: `make docs`. With INTERSPHINX=1 they link to other libraries, over the network."""

import logging
import os
import sys
import warnings
from pathlib import Path

from sphinx_gallery.sorting import ExplicitOrder

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "_ext"))

from thumbnails import scraper  # noqa: E402

from asperity import __version__  # noqa: E402
from asperity.errors import Remark  # noqa: E402

warnings.filterwarnings("ignore", category=Remark)  # that loops are compiled is of this machine alone

project = "Asperity"
author = "The Asperity developers"
copyright = author  # noqa: A001
version = release = __version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_gallery.gen_gallery",
    "generated",
    "numbers_of_studies",
]
if os.environ.get("INTERSPHINX"):
    extensions.append("sphinx.ext.intersphinx")
    intersphinx_timeout = 10
    # An inventory that cannot be had costs links, not the build.
    logging.getLogger("sphinx.sphinx.ext.intersphinx").addFilter(
        lambda record: "inventories" not in str(record.msg)
    )
intersphinx_mapping = {
    "python": ("https://docs.python.org/3", None),
    "numpy": ("https://numpy.org/doc/stable", None),
    "scipy": ("https://docs.scipy.org/doc/scipy", None),
    "xarray": ("https://docs.xarray.dev/en/stable", None),
}
exclude_patterns = ["_build", "_ext", "data", "gallery/*"]
myst_enable_extensions = ["colon_fence", "deflist"]
myst_heading_anchors = 4
default_role = "py:obj"
smartquotes_action = "D"  # quotation marks stay as one types them
suppress_warnings = ["config.cache"]  # the gallery's functions cannot be pickled

autodoc_typehints = "description"
autodoc_typehints_description_target = "documented_params"
autodoc_member_order = "bysource"
# matplotlib gives each class derived from its own a method `set`, whose description has roles of its own.
autodoc_default_options = {"members": True, "exclude-members": "set"}
autodoc_type_aliases = {name: name for name in ("ArrayLike", "Field", "Mask", "Floats")}
toc_object_entries_show_parents = "hide"
napoleon_google_docstring = False
napoleon_use_ivar = True
napoleon_use_rtype = False

sphinx_gallery_conf = {
    "examples_dirs": "gallery",
    "gallery_dirs": "auto_gallery",
    "filename_pattern": r"\.py$",
    "ignore_pattern": r"__init__\.py",
    "subsection_order": ExplicitOrder(
        [
            f"gallery/{section}"
            for section in ("contacts", "surfaces", "materials", "histories", "studies", "data")
        ]
        + ["*"]
    ),
    "within_subsection_order": "FileNameSortKey",
    "abort_on_example_error": True,
    "only_warn_on_example_error": False,
    "remove_config_comments": True,
    "image_scrapers": (scraper,),
    "capture_repr": ("_repr_html_",),
    "show_memory": False,
    "write_computation_times": False,  # the page of times would read the network
    "show_signature": False,
    "download_all_examples": False,
    "min_reported_time": 3600,
    "plot_gallery": "True",
}
html_math_renderer = "mathml"
html_theme = "pydata_sphinx_theme"
html_title = f"Asperity {version}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_search_scorer = str(HERE / "_ext" / "scorer.js")
html_copy_source = False
html_show_sourcelink = False
html_sidebars = {"start": []}  # it has no pages below it
html_theme_options = {
    "logo": {"text": "Asperity"},
    "navigation_with_keys": False,
    "show_toc_level": 2,
    "show_prev_next": True,
    "header_links_before_dropdown": 8,
    "navbar_align": "left",
    "footer_start": ["copyright"],
    "footer_end": [],
}
