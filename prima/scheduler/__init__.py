"""The mediator: decides which application's behaviour runs when (thesis chapter 4)."""
