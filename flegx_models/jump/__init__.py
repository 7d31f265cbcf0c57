"""The jump of chapter 6: worms that rub, a ground that pushes, a plan, a controller.

`simulation` runs the experiment; `machine` is the hybrid system, `instant` one step of
it, `mechanics` what the bond graph in `leg_graph` says, `worm` the friction, `sampled`
the controller as it runs.
"""
