"""ECMAScript of documents: what Python evaluates itself, and engines for all else."""
