"""The search: hypotheses screened, fitted and added, one piece of physics at a time."""
