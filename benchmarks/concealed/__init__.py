"""Machines with concealed physics, and the scoreboard of the tool that looks for it.

The simulator below shares no law, no integrator and no graph code with `bondgraph`. It
only writes base models, as text, and recordings, as CSV.
"""
