"""Where left-out physics can sit: a closed family of places.

A place is a junction, a bond, an element, an input, an output, or two junctions that
nothing joins. Each knows the graph around it and the typical sizes of its signals, and
builds the edits that are possible there.
"""
