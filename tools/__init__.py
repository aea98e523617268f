"""Tools for developers: they write parts of the documentation from the code, and try mutants."""
