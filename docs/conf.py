"""How the pages become a site: ``sphinx-build -W docs build/site``.

Sphinx reads the Markdown as it stands. Pages that repeat what the code says of itself,
the reference, the cookbook and the gallery, are written by `bookmaking` before Sphinx
looks for sources, and are not kept in the repository. The site loads nothing from
elsewhere and works from a folder: mathematics becomes MathML, search is a local index.
"""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

from bookmaking import (  # noqa: E402
    links,
    markup,
    mathml,
    notebooks,
    reference,
    writing,
)

import bondgraph  # noqa: E402

project = "bondgraph"
author = "The bondgraph-workbench authors"
version = release = bondgraph.__version__
language = "en"

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
]
exclude_patterns = ["_build", "bookmaking", "**/.*", "**/generated/*.inc"]
source_suffix = {".md": "myst-nb", ".ipynb": "myst-nb"}
# Notebooks are shown with what they gave when they were last executed.
nb_execution_mode = "off"
suppress_warnings = ["myst-nb.lexer"]  # of a notebook that was never executed

myst_enable_extensions = ["attrs_inline", "deflist", "dollarmath"]
myst_heading_anchors = 3

default_role = "code"
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented_params"
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True
napoleon_numpy_docstring = True
napoleon_google_docstring = False
napoleon_use_rtype = False
maximum_signature_line_length = 70
python_use_unqualified_type_names = True
add_module_names = False
toc_object_entries_show_parents = "hide"

html_theme = "pydata_sphinx_theme"
html_title = "bondgraph"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_math_renderer = "mathml"
html_copy_source = False
html_show_sphinx = False
html_theme_options = {
    "navbar_align": "left",
    "header_links_before_dropdown": 7,
    "show_prev_next": True,
    "navigation_with_keys": True,
    "pygments_light_style": "a11y-high-contrast-light",
    "pygments_dark_style": "a11y-high-contrast-dark",
    "footer_start": ["copyright"],
    "footer_end": ["theme-version"],
}
html_context = {"default_mode": "auto"}
html_sidebars = {"index": [], "gallery": [], "glossary": []}


def setup(app):  # type: ignore[no-untyped-def]
    """Register the renderer of mathematics, and write the pages that are written."""
    mathml.register(app)
    app.connect("autodoc-process-docstring", reference.escape_bars)
    app.connect("doctree-read", links.name_files_outside)
    app.connect("doctree-read", notebooks.read_as_ipython)
    app.connect("build-finished", markup.mend_all)
    app.connect("config-inited", lambda app, config: writing.write_all(HERE))
