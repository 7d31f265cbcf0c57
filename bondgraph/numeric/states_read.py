"""A model whose states are outputs too, in each of its forms."""

from dataclasses import replace

import numpy as np

from bondgraph.numeric.model import NumericModel
from bondgraph.numeric.tape import Tape


def with_states_read(model: NumericModel) -> NumericModel:
    """Return the model with its states as further outputs, after its own."""
    return _read(model, len(model.output_names))


def _read(model: NumericModel, after: int) -> NumericModel:
    """Return the model with its states read after that many outputs."""
    names, units = list(model.output_names), list(model.output_units)
    names[after:after] = model.state_names
    units[after:after] = ["1"] * model.n_states
    dry, contacts = model.set_valued, model.contacts
    if dry is not None:
        dry = replace(dry, output=_inserted(dry.output, after, model.n_states))
    if contacts is not None:
        contacts = replace(contacts, held=_read(contacts.held, after))
    return replace(
        model,
        output=_inserted(model.output, after, model.n_states),
        output_names=tuple(names),
        output_units=tuple(units),
        set_valued=dry,
        contacts=contacts,
    )


def _inserted(tape: Tape, after: int, n_states: int) -> Tape:
    """Return the tape with its first variables, the states, among its results."""
    return replace(
        tape,
        outputs=np.insert(tape.outputs, after, np.arange(n_states)),
        degree=np.insert(tape.degree, after, np.zeros(n_states, np.int64)),
    )
