"""The implicit route: a graph as one sparse system, with nothing derived by causality.

Every bond keeps one effort and one flow and every storage what it stores; junctions,
two-ports and laws are rows. It shares no code with causality and the symbolic
equations, so that each of the two routes checks the other, and its cost is linear in
the size of the graph.
"""
