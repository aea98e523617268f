"""One interpreter for each document: the Form Interpretation Algorithm, without I/O or clock."""
