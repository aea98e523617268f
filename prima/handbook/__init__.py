"""What `prima explain` tells: the rules with their runs, and examples of every problem."""
