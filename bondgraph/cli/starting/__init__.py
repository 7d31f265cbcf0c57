"""What ``bondgraph new`` starts from: three machines, each a model and its recordings.

`motor`, `spring` and `tanks` are the model files, copied as they are. `benches` steps
machines that have one thing more than these models, by hand and with no law of the
toolkit, so that there is something to find. `starts` names and describes them.
"""
