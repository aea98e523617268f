"""The tables of PRIMA's language: Commands and kinds of values."""
