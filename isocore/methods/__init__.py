"""How each method is run: what it may be told, its kernels called, its facts by the report's keys.

A method is a function `prepare(field, options)` here and a row in backends.py.
"""
