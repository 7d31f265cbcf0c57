"""Where everything in the picture of a bond graph sits."""
