"""The picture of a bond graph: what is drawn where the layout put it."""
