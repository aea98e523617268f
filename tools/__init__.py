"""What writes parts of the documentation from the code, and what tries mutants of the code."""
