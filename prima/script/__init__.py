"""ECMAScript in documents: simple code is evaluated in Python, all other code by engines."""
