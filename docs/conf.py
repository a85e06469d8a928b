"""The documentation as a site: Sphinx, with pages in Markdown and parts made from the code."""

import sys
from importlib.metadata import version as version_of
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))  # for `sheets`

project = "railgate"
author = "the railgate authors"
copyright = "the railgate authors, Apache-2.0"
version = release = version_of("railgate")

extensions = ["myst_parser", "sheets"]
myst_enable_extensions = ["colon_fence", "deflist"]
myst_heading_anchors = 3
exclude_patterns = ["sheets"]
suppress_warnings = ["myst.header"]  # commands.md and vital_output.md begin where they must

language = "en-GB"
smartquotes = False  # quotation marks and dashes stand as they are meant
nitpicky = True

html_theme = "furo"
pygments_dark_style = "github-dark"
html_title = "railgate"
html_static_path = ["_static"]
html_css_files = ["railgate.css"]
html_show_sphinx = False
html_copy_source = False
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#1d4f91", "color-brand-content": "#1d4f91"},
    "dark_css_variables": {"color-brand-primary": "#8ab4f8", "color-brand-content": "#8ab4f8"},
}
