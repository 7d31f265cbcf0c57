"""What recordings tell of the estimates: errors, combinations, profiles."""
