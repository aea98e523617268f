"""Editor support while documents are written: problems, completion, names, documentation.

Everything here works on texts that need not be well-formed. Only :mod:`prima.lsp.server`,
``answers`` and ``protocol`` use the Language Server Protocol.
"""
