"""Reading XML that a stranger wrote: hardened, with exact places, against a table of elements."""
