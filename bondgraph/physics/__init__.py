"""The library of physics that models leave out; one file per family.

An entry of the library is an `AbstractPhysics`: given a graph, a place and typical
sizes of the variables there, it proposes hypotheses, each a graph edit with its law,
its parameters and its words. `LIBRARY` lists them all; users pass their own beside
them.
"""
