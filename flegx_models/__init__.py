"""FlegX, a leg with worm gears and a flexible link, as its master thesis models it.

The thesis is cited as "FlegX thesis" with its tables, sections and equations. The
models are drawn as bond graphs and everything else is derived from them.
"""
