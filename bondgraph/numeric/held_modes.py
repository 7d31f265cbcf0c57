"""The ordinary model that one with set-valued friction is while its modes are given.

Each mode is two parameters more, σ (1 where it sticks) and m (the force over its limit
where it slips), see `SetValuedForm.held`. A friction that slips with no force at all is
none: with all of them zero it is the same machine with its frictions let go of.
"""

from dataclasses import replace

from bondgraph.numeric.model import NumericModel


def with_modes_given(model: NumericModel) -> NumericModel | None:
    """Return the model with its modes as further parameters, σ and m of each friction.

    They come after its own. None where nothing is dry. Gaps of hard contacts are open.
    """
    form = model.set_valued
    if form is None:
        return None
    modes = [
        f"{part} of {place}" for place in form.places for part in ("stick", "slip")
    ]
    return replace(
        model,
        dynamics=form.held,
        output=form.output,
        n_unknowns=model.n_unknowns + len(form.places),
        unknown_names=(*model.unknown_names, *form.places),
        parameter_names=(*model.parameter_names, *modes),
        linear=form.linear,
        instantaneous=form.instantaneous,
        set_valued=None,
        contacts=None,
    )
