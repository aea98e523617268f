"""What an editor asks while somebody writes: problems, completion, names, documentation.

Everything here works on texts that need not be well-formed. :mod:`prima.lsp.server`
alone speaks the Language Server Protocol.
"""
