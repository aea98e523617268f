"""Drivers against second parties that are not PRIMA's: ``make test-live``.

Each folder here has an environment of its own (``tools/environments.py``). A party that
cannot be installed or started is an error, never a skip.
"""
