"""The content of `prima explain`: the rules with their runs, and examples of every problem."""
