"""Other methods on the same cases: what they locate, name and extrapolate.

They are given more than the tool is: the base model's equations without a graph, and
the state of rest at which every recording begins.
"""
