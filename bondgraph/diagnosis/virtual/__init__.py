"""Virtual sources: what a missing effort, flow, input or reading would do.

Every place of a model gets a source of value zero. The sensitivities of the simulation
to these values say, exactly and for all places at once, how the outputs would move if
something were missing there.
"""
