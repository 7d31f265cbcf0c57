"""One hypothesis on the base model: its promise, its fit, its worth."""
