"""Numbers: the gate from symbols to arrays, and the compiled kernel behind it."""
