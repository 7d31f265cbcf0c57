"""Pages that say what the code says of itself: the reference, the cookbook, pictures.

They are written from the records of the library, so that they cannot go stale, and
before Sphinx looks for sources (`writing.write_all`). Nothing of them is kept in the
repository.
"""
