"""Carrying out plans: the monitor (pure), recovery, the executor and its trace.

Nothing is imported here, so that the monitor can be used, and a trace replayed, where numpy is not installed.
"""
