"""Editor support while documents are written: problems, completion, names, documentation.

Everything here works on texts that need not be well-formed. :mod:`prima.lsp.server`
and ``protocol`` alone use the Language Server Protocol.
"""
