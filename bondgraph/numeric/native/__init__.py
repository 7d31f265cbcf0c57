"""One model as machine code: its tapes become LLVM assembly, ready in milliseconds.

The time loops around it are compiled once for all models and call it by address.
"""
