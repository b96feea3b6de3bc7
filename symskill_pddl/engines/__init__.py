"""Engines as they are called in a process of their own: the standard library and the engine, nothing else of this package.

`planning.worker` starts one process for each engine and keeps it. What a module here needs is `load(...)`, which takes a domain
and gives a function that takes a problem and a time limit; `serve` does the rest.
"""
