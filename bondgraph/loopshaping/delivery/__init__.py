"""From a controller on paper to one that runs: sampled, quantised, in C."""
