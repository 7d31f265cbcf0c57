"""Loops compiled once by numba and kept on disk: how, where, and what they share.

All that compiled loops are made of lies here, in `bondgraph.numeric.native` or in
`bondgraph.numeric.kernel`, or in the file of the loop itself.
"""
