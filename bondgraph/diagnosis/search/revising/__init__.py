"""Second thoughts: what was added is taken out, exchanged, or told more plainly."""
