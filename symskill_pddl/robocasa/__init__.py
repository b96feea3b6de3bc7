"""RoboCasa's kitchens as a second world, and a small asset pack of our own that they build with.

Nothing here is imported by what learns, plans or executes. RoboCasa is imported when a kitchen is opened, not before.
"""
