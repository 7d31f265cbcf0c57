"""What a notebook shows for graphs, equations, recordings, fits and diagnoses.

The records know nothing of pictures, which are made on a higher floor; so a notebook is
told here how to show them. They are named and not imported: ``%load_ext bondgraph``
takes no time, and a picture is made when one is shown.
"""

from collections.abc import Callable
from functools import partial
from importlib import import_module
from typing import Any

_HTML = {
    "bondgraph.structure.builder": {"BondGraph": "pictures:builder_html"},
    "bondgraph.structure.graph": {"FinishedGraph": "pictures:finished_html"},
    "bondgraph.structure.parameters": {"ParameterSet": "tables:parameters_html"},
    "bondgraph.causality.records": {"CausalAssignment": "tables:causality_html"},
    "bondgraph.recordings.recording": {"Recording": "charts:recording_html"},
    "bondgraph.recordings.binding": {"BoundRecording": "charts:bound_html"},
    "bondgraph.fitting.simulate": {"Solution": "charts:solution_html"},
    "bondgraph.simulation.run": {"Run": "charts:run_html"},
    "bondgraph.fitting.result": {"FitResult": "tables:fit_html"},
    "bondgraph.fitting.certainty.profile": {"Profile": "charts:profile_html"},
    "bondgraph.diagnosis.records": {"Diagnosis": "pictures:diagnosis_html"},
}
_LATEX = {
    "bondgraph.equations.state_equations": {"StateEquations": "formulas:equations"},
    "bondgraph.equations.transfer.linear": {"LinearSystem": "formulas:linear_system"},
    "bondgraph.equations.transfer.transfer_function": {
        "TransferFunction": "formulas:transfer"
    },
}


def load_ipython_extension(shell: Any) -> None:
    """Let a notebook show graphs and answers; ``%load_ext bondgraph`` calls this.

    Parameters
    ----------
    shell
        The IPython shell.
    """
    for mime, shown in (("text/html", _HTML), ("text/latex", _LATEX)):
        formatter = shell.display_formatter.formatters[mime]
        for module, kinds in shown.items():
            for kind, function in kinds.items():
                formatter.for_type_by_name(module, kind, partial(_show, function))


def as_html(shown: object) -> str:
    """Return what a notebook shows for an object, for other front ends and pages.

    Parameters
    ----------
    shown
        A graph, causality, recording, simulation, fit, profile or diagnosis.

    Raises
    ------
    TypeError
        If there is no picture of such an object.
    """
    kind = type(shown)
    function = _HTML.get(kind.__module__, {}).get(kind.__name__)
    if function is None:
        raise TypeError(f"there is no picture of {kind.__name__!r} objects")
    return _show(function, shown)


def _show(function: str, shown: object) -> str:
    module, name = function.split(":")
    maker: Callable[[object], str] = getattr(
        import_module(f"bondgraph.notebook.{module}"), name
    )
    return maker(shown)
