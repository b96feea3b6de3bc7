"""Suites of seeded episodes, run in parallel, with honest statistics.

- `goals`: from a library's learned goals to ground atoms of one episode.
- `trial`: one episode from its seed to its outcome.
- `suite`: many of them over processes, and the results file.
- `statistics`: what may be said of a success rate.
"""
