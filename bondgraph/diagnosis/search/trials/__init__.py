"""One hypothesis on the base model: its promise, its fit, and whether it is worth one."""
