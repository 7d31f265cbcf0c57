"""What to measure next: the input or the sensor that would tell alternatives apart."""
