"""The base model: fitted, in steps fine enough, over as long as it can be simulated."""
