"""The interpreted kernel: one compiled program runs the tapes of every model.

Nothing is compiled for a model, so a hypothesis costs no more than its steps. Where a
model with friction keeps its modes, its steps are taken in `bondgraph.numeric.native`.
"""
