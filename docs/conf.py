"""Configuration of the documentation: ``make docs`` builds it, warnings are errors."""

import importlib.metadata
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]  # computed, reproductions

# Sphinx wants to see the folder of computed pages before they are computed.
(HERE / "_generated" / "pages").mkdir(parents=True, exist_ok=True)

project = "spurcheck"
author = copyright = "The spurcheck developers"
release = version = importlib.metadata.version("spurcheck")

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx_gallery.gen_gallery",
    "extensions.gallery",
    "extensions.mathml",
    "extensions.docstrings",
    "extensions.plain_mathematics",
    "extensions.contributing",
    "computed",
]
exclude_patterns = ["_generated", "images"]
myst_enable_extensions = ["dollarmath", "amsmath", "attrs_inline", "deflist", "colon_fence"]
myst_heading_anchors = 3

autodoc_typehints = "description"
autodoc_typehints_description_target = "documented_params"
autodoc_type_aliases = {"ArrayLike": "ArrayLike", "FloatArray": "FloatArray"}
autodoc_member_order = "bysource"
autodoc_default_options = {"members": True, "exclude-members": "model_config"}
python_maximum_signature_line_length = 80

html_theme = "furo"
html_title = f"spurcheck {release}"
html_static_path = ["static"]
html_extra_path = ["_generated/pages"]
html_css_files = ["spurcheck.css"]
html_show_sphinx = False
html_copy_source = False
html_theme_options = {"navigation_with_keys": True}

sphinx_gallery_conf = {
    "examples_dirs": str(HERE.parent / "examples"),
    "gallery_dirs": "gallery",
    "filename_pattern": r"/\d\d_",
    "ignore_pattern": r"__init__\.py",
    "image_scrapers": "extensions.gallery.scraper",
    "reset_modules": "extensions.gallery.catch_saved_figures",
    "abort_on_example_error": True,
    "only_warn_on_example_error": False,
    "download_all_examples": False,
    "show_memory": False,
    "min_reported_time": 1.0,
    "write_computation_times": False,
    "within_subsection_order": "FileNameSortKey",
    "copyfile_regex": "",
    "notebook_extensions": set(),
    "show_signature": False,
}
